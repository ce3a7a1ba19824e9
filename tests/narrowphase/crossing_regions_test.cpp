#include <grapeshot/narrowphase/crossing_regions.hpp>

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <grapeshot/core/instruction_set.hpp>
#include "support/poses.hpp"
#include "support/test_size.hpp"

namespace grapeshot {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using test::Random;

constexpr float noNumber = std::numeric_limits<float>::quiet_NaN();
constexpr float noBound = std::numeric_limits<float>::infinity();

std::vector<CrossingRegion> grouped(std::span<const CurvePiece> pieces, const RegionSettings& settings = {},
                                    std::uint64_t steps = 20) {
    std::vector<CrossingRegion> regions(3);  // overwritten
    groupCrossing(pieces, steps, settings, defaultCalibration(), regions);
    return regions;
}

/// Pieces along a few curves of their own directions; some proven, some with an extent, some of no direction.
std::vector<CurvePiece> randomPieces(std::size_t count, float extent, Random& random) {
    std::vector<CurvePiece> pieces(count);
    Vector3f place = Vector3f::Zero();
    Vector3f way = Vector3f::UnitX();
    for (std::size_t i = 0; i < count; ++i) {
        CurvePiece& piece = pieces[i];
        if (random.bits() % 30 == 0) {
            place = static_cast<float>(random.uniform(0, 2)) * random.direction();
            way = static_cast<float>(random.uniform(0.5, 2)) * random.direction();
        }
        place += 0.05F * random.direction();
        piece.position = place;
        piece.direction = way + 0.7F * static_cast<float>(random.unit()) * random.direction();
        piece.length = 0.001F + 0.05F * static_cast<float>(random.unit());
        piece.extent = random.bits() % 2 == 0 ? 0 : extent * static_cast<float>(random.unit());
        piece.slope = static_cast<float>(random.unit());
        piece.rate = 0.02F * static_cast<float>(random.unit());
        if (random.bits() % 8 == 0) {
            piece.rate = noBound;
            piece.pair = {static_cast<std::uint32_t>(i), 7};
        }
    }
    return pieces;
}

using Members = std::vector<std::uint32_t>;

/// All in the list that can be reached from `seed`, in any number of strides.
Members connectedWith(std::uint32_t seed, const Members& list, const std::vector<CurvePiece>& pieces, double spacing) {
    Members rest = list;
    Members found{seed};
    std::erase(rest, seed);
    for (std::size_t next = 0; next < found.size(); ++next) {
        const CurvePiece& from = pieces[found[next]];
        for (const std::uint32_t i : Members(rest)) {
            if ((pieces[i].position - from.position).cast<double>().norm() <=
                spacing + double{from.extent} + double{pieces[i].extent}) {
                found.push_back(i);
                std::erase(rest, i);
            }
        }
    }
    std::ranges::sort(found);
    return found;
}

/// The definition, word for word. `unsure` if rounding may decide otherwise.
std::vector<Members> regionsByDefinition(const std::vector<CurvePiece>& pieces, const RegionSettings& settings,
                                         bool& unsure) {
    Members left(pieces.size());
    std::iota(left.begin(), left.end(), 0U);
    std::vector<Members> regions;
    while (!left.empty()) {
        const Members connected = connectedWith(left.front(), left, pieces, settings.spacing);
        Vector3d mean = Vector3d::Zero();
        for (const std::uint32_t i : connected) {
            mean += double{pieces[i].length} * pieces[i].direction.cast<double>();
        }
        mean.normalize();
        Members inCone;
        for (const std::uint32_t i : connected) {
            const double cosine = pieces[i].direction.cast<double>().normalized().dot(mean);
            unsure |= std::abs(cosine - settings.normalCone) < 2e-6;
            if (cosine >= settings.normalCone) {
                inCone.push_back(i);
            }
        }
        const auto heaviest = [&](const Members& list) {
            return *std::ranges::max_element(list, {}, [&](std::uint32_t i) { return pieces[i].length; });
        };
        if (inCone.empty()) {  // they cancel: about the heaviest's own direction
            const std::uint32_t seed = heaviest(connected);
            for (const std::uint32_t i : connected) {
                const double cosine = pieces[i].direction.cast<double>().normalized().dot(
                    pieces[seed].direction.cast<double>().normalized());
                unsure |= i != seed && std::abs(cosine - settings.normalCone) < 2e-6;
                if (i == seed || cosine >= settings.normalCone) {
                    inCone.push_back(i);
                }
            }
        }
        regions.push_back(connectedWith(heaviest(inCone), inCone, pieces, settings.spacing));
        std::erase_if(left, [&](std::uint32_t i) { return std::ranges::binary_search(regions.back(), i); });
    }
    return regions;
}

/// What the header says of a region, in double precision.
void expectSummary(const CrossingRegion& region, const std::vector<CurvePiece>& pieces, const Members& members,
                   std::uint64_t steps) {
    double length = 0;
    float rate = 0;
    Vector3d position = Vector3d::Zero();
    Vector3d direction = Vector3d::Zero();
    const CurvePiece* longest = nullptr;
    for (const std::uint32_t i : members) {
        const CurvePiece& piece = pieces[i];
        length += piece.length;
        position += double{piece.length} * piece.position.cast<double>();
        direction += double{piece.length} * piece.direction.cast<double>();
        if (!piece.proven()) {
            rate += piece.rate;
        } else if (longest == nullptr || piece.length > longest->length) {
            longest = &piece;
        }
    }
    position /= length;
    EXPECT_NEAR(region.length, length, 1e-5 * length);
    EXPECT_LE((region.position.cast<double>() - position).norm(), 1e-5);
    EXPECT_NEAR(region.normal.norm(), 1, 1e-5);
    EXPECT_LE((region.normal.cast<double>() - direction.normalized()).norm(), 1e-4 * length / direction.norm());
    double squares = 0;
    double open = 0;
    double depth = 0;
    for (const std::uint32_t i : members) {
        const CurvePiece& piece = pieces[i];
        const double share = piece.length / length;
        const Vector3d arm = piece.position.cast<double>() - position;
        const double squaredExtent = double{piece.extent} * piece.extent;
        squares += share * (arm.squaredNorm() + squaredExtent);
        open += piece.proven() ? 0 : share * share * squaredExtent;
        const Vector3d across = arm - arm.dot(direction.normalized()) * direction.normalized();
        depth += share * piece.slope * std::sqrt(across.squaredNorm() + 2 * squaredExtent / 3);
    }
    EXPECT_NEAR(region.extent, std::sqrt(squares), 1e-4);
    EXPECT_NEAR(region.positionError, std::sqrt(open), 1e-5);
    EXPECT_NEAR(region.depth, depth, 1e-3);
    EXPECT_EQ(region.proven, longest != nullptr);
    EXPECT_EQ(region.pair, longest != nullptr ? longest->pair : TrianglePair());
    if (region.proven) {
        EXPECT_EQ(region.probability, 1);
    } else {
        // A part of the pieces had its part of the steps.
        const std::uint64_t own = std::max<std::uint64_t>(steps * members.size() / pieces.size(), 1);
        EXPECT_NEAR(region.probability, probabilityOfRegion(defaultCalibration(), std::max(rate, 1e-30F), own), 1e-4);
        EXPECT_GT(region.probability, 0);
        EXPECT_LT(region.probability, 1);
    }
}

TEST(CrossingRegions, AreThoseOfTheDefinition) {
    Random random(1);
    const std::size_t sizes[] = {0, 1, 2, 10, 50, 64, 65, 150, 300, 2000};
    int compared = 0;
    int split = 0;
    int shared = 0;
    for (std::size_t trial = 0; trial < test::sampleSize(60, 600); ++trial) {
        const float extents[] = {0, 0.03F, 0.2F};
        const std::vector<CurvePiece> pieces = randomPieces(sizes[trial % 10], extents[trial % 3], random);
        const RegionSettings settings{.spacing = 0.06F + 0.06F * static_cast<float>(random.unit()),
                                      .normalCone = trial % 4 == 0 ? 0.95F : 0.5F};
        bool unsure = false;
        std::vector<Members> expected = regionsByDefinition(pieces, settings, unsure);
        if (unsure) {
            continue;
        }
        const auto lengthOf = [&](const Members& members) {
            return std::accumulate(members.begin(), members.end(), 0.0,
                                   [&](double sum, std::uint32_t i) { return sum + double{pieces[i].length}; });
        };
        std::ranges::sort(expected, std::greater(), lengthOf);
        const std::uint64_t steps = 1 + random.bits() % 100;
        const std::vector<CrossingRegion> regions = grouped(pieces, settings, steps);
        ASSERT_EQ(regions.size(), expected.size()) << trial;
        for (std::size_t r = 0; r < regions.size(); ++r) {
            SCOPED_TRACE(testing::Message() << trial << ", region " << r);
            expectSummary(regions[r], pieces, expected[r], steps);
            if (testing::Test::HasFailure()) {
                return;
            }
        }
        ++compared;
        split += expected.size() > 3 ? 1 : 0;
        shared += expected.size() < pieces.size() ? 1 : 0;
    }
    EXPECT_GT(compared, 40);
    EXPECT_GT(split, 20);
    EXPECT_GT(shared, 30) << "regions of more than one piece";
}

TEST(CrossingRegions, OppositeSidesAreApart) {
    // A rod through a plate: the curves of both faces push opposite ways, and cancel.
    std::vector<CurvePiece> pieces(4);
    for (int i = 0; i < 4; ++i) {
        pieces[static_cast<std::size_t>(i)].position = {0.01F * static_cast<float>(i), 0, 0};
        pieces[static_cast<std::size_t>(i)].direction = {0, i % 2 == 0 ? 1.0F : -1.0F, 0};
        pieces[static_cast<std::size_t>(i)].length = 0.1F;
    }
    const auto regions = grouped(pieces);
    ASSERT_EQ(regions.size(), 2U);
    EXPECT_EQ(regions[0].normal, -regions[1].normal);
    EXPECT_NEAR(regions[0].length, 0.2F, 1e-6F);
    // No cone at all puts them together, with some unit normal; one that nothing is in parts them all.
    ASSERT_EQ(grouped(pieces, {.normalCone = -1}).size(), 1U);
    EXPECT_NEAR(grouped(pieces, {.normalCone = -1})[0].normal.norm(), 1, 1e-6);
    EXPECT_EQ(grouped(pieces, {.normalCone = 2}).size(), 4U);
}

TEST(CrossingRegions, HardlyDependOnTheOrderOfThePieces) {
    Random random(2);
    for (int trial = 0; trial < 30; ++trial) {
        std::vector<CurvePiece> pieces = randomPieces(200, 0.05F, random);
        bool unsure = false;
        (void)regionsByDefinition(pieces, {}, unsure);
        if (unsure) {
            continue;
        }
        const auto before = grouped(pieces);
        for (std::size_t i = pieces.size(); i > 1; --i) {
            std::swap(pieces[i - 1], pieces[random.bits() % i]);
        }
        const auto after = grouped(pieces);
        ASSERT_EQ(before.size(), after.size());
        for (std::size_t r = 0; r < before.size(); ++r) {
            EXPECT_NEAR(before[r].length, after[r].length, 1e-5F);
            EXPECT_EQ(before[r].pair, after[r].pair);
        }
    }
}

TEST(CrossingRegions, SameOnEveryInstructionSet) {
    const InstructionSet before = instructionSet();
    Random random(3);
    for (const std::size_t count : {20, 400, 1500}) {
        const std::vector<CurvePiece> pieces = randomPieces(count, 0.05F, random);
        std::vector<CrossingRegion> first;
        for (const InstructionSet set : {InstructionSet::scalar, InstructionSet::avx2, InstructionSet::avx512}) {
            limitInstructionSet(set);
            const auto regions = grouped(pieces);
            first = first.empty() ? regions : first;
            ASSERT_EQ(regions.size(), first.size());
            for (std::size_t r = 0; r < regions.size(); ++r) {
                EXPECT_TRUE(regions[r].position == first[r].position && regions[r].normal == first[r].normal &&
                            regions[r].extent == first[r].extent && regions[r].depth == first[r].depth &&
                            regions[r].length == first[r].length && regions[r].pair == first[r].pair &&
                            regions[r].probability == first[r].probability &&
                            regions[r].positionError == first[r].positionError);
            }
        }
    }
    limitInstructionSet(before);
}

TEST(CrossingRegions, TouchingPiecesAreRegionsWithoutLength) {
    std::vector<CurvePiece> pieces(3);
    for (std::size_t i = 0; i < 3; ++i) {
        pieces[i].position = {0.01F * static_cast<float>(i), 0, 0};
        pieces[i].direction = {0, 1, 0};
        pieces[i].pair = {static_cast<std::uint32_t>(i), 2};
        pieces[i].rate = noBound;
    }
    auto regions = grouped(pieces);
    ASSERT_EQ(regions.size(), 1U);
    EXPECT_EQ(regions[0].length, 0);
    EXPECT_TRUE(regions[0].proven);
    EXPECT_EQ(regions[0].probability, 1);
    EXPECT_LE((regions[0].position - Vector3f(0.01F, 0, 0)).norm(), 1e-6F);
    EXPECT_EQ(regions[0].normal, Vector3f::UnitY());
    // Beside one with a length they hardly count.
    CurvePiece& added = pieces.emplace_back();
    added.position = {0.09F, 0, 0};
    added.direction = {1, 0.5F, 0};
    added.length = 0.1F;
    regions = grouped(pieces, {.normalCone = 0.1F});
    ASSERT_EQ(regions.size(), 1U);
    EXPECT_LE((regions[0].position - added.position).norm(), 1e-5F);
    EXPECT_NEAR(regions[0].normal.dot(added.direction.normalized()), 1, 1e-5);
}

TEST(CrossingRegions, NumbersThatAreNoneAreIgnored) {
    Random random(4);
    const std::vector<CurvePiece> sound = randomPieces(60, 0.03F, random);
    const auto expected = grouped(sound);
    for (const float bad : {noNumber, noBound, -noBound}) {
        std::vector<CurvePiece> pieces = sound;
        const auto add = [&](auto&& spoil) {
            CurvePiece piece = sound[pieces.size() % sound.size()];
            piece.rate = 0.1F;
            piece.pair = {};
            spoil(piece);
            pieces.push_back(piece);
        };
        add([&](CurvePiece& piece) { piece.position.x() = bad; });
        add([&](CurvePiece& piece) { piece.direction.y() = bad; });
        add([&](CurvePiece& piece) { piece.direction = Vector3f::Constant(bad); });
        add([&](CurvePiece& piece) { piece.length = bad; });
        add([&](CurvePiece& piece) { piece.extent = bad; });
        add([&](CurvePiece& piece) { piece.slope = bad; });
        add([&](CurvePiece& piece) { piece.rate = bad; });
        add([&](CurvePiece& piece) { piece.direction.setZero(); });
        const auto regions = grouped(pieces);
        ASSERT_EQ(regions.size(), expected.size());
        for (std::size_t r = 0; r < regions.size(); ++r) {
            EXPECT_EQ(regions[r].position, expected[r].position);
            EXPECT_EQ(regions[r].depth, expected[r].depth);
            EXPECT_EQ(regions[r].probability, expected[r].probability);
        }
    }
    EXPECT_TRUE(grouped({}).empty());
}

}  // namespace
}  // namespace grapeshot
