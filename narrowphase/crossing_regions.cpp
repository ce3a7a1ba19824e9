#include <grapeshot/narrowphase/crossing_regions.hpp>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>

#include <grapeshot/narrowphase/detail/piece_flood.hpp>

namespace grapeshot {
namespace {

using Eigen::Vector3f;

/// The pieces that count, side by side.
struct Pieces {
    std::vector<std::uint32_t> source;  ///< index in the caller's
    std::vector<float> weight;          ///< m, > 0
    detail::FloodPieces places;

    void take(std::span<const CurvePiece> all, float spacing);
};

/// All numbers are numbers, and it pushes some way.
bool counts(const CurvePiece& piece) {
    const float squaredNorm = piece.direction.squaredNorm();
    return squaredNorm > 1e-12F && std::isfinite(squaredNorm) && piece.position.allFinite() &&
           std::isfinite(piece.length + piece.extent + piece.slope) && (piece.proven() || std::isfinite(piece.rate));
}

void Pieces::take(std::span<const CurvePiece> all, float spacing) {
    source.clear();
    weight.clear();
    places.reset(all.size());
    const float touching = std::max(1e-6F * spacing, 1e-30F);  // the weight of triangles that only touch
    for (std::uint32_t i = 0; i < all.size(); ++i) {
        const CurvePiece& piece = all[i];
        if (!counts(piece)) {
            continue;
        }
        source.push_back(i);
        weight.push_back(std::max(piece.length, touching));
        places.add(piece.position, piece.direction / piece.direction.norm(), piece.extent);
    }
    places.finish();
}

/// The heaviest of `among` within the cone about the axis; `among.size()` if none is.
std::size_t heaviest(const Pieces& pieces, const std::vector<std::uint32_t>& among, const Vector3f& axis, float cone) {
    std::size_t best = among.size();
    for (std::size_t i = 0; i < among.size(); ++i) {
        if ((best == among.size() || pieces.weight[among[i]] > pieces.weight[among[best]]) &&
            pieces.places.direction(among[i]).dot(axis) >= cone) {
            best = i;
        }
    }
    return best;
}

/// Of so many steps, those that a region had: as its part of the pieces. (Row by row the calibration asks for more rate
/// the longer nothing was found, and all steps would be asked of each region.)
std::uint64_t stepsOf(std::uint64_t steps, std::uint64_t members, std::uint64_t all) {
    return std::max<std::uint64_t>(steps / all * members + steps % all * members / all, 1);
}

CrossingRegion summary(std::span<const CurvePiece> all, const Pieces& pieces, const std::vector<std::uint32_t>& members,
                       std::uint64_t steps, const Calibration& calibration) {
    CrossingRegion region;
    const Vector3f origin = pieces.places.position(members.front());  // keeps precision far from the frame's origin
    float weight = 0;
    float longest = -1;
    Vector3f position = Vector3f::Zero();
    Vector3f direction = Vector3f::Zero();
    for (const std::uint32_t i : members) {
        const CurvePiece& piece = all[pieces.source[i]];
        const float w = pieces.weight[i];
        weight += w;
        position += w * (piece.position - origin);
        direction += w * piece.direction;
        region.length += piece.length;
        if (!piece.proven()) {
            region.rate += piece.rate;
        } else if (piece.length > longest) {
            longest = piece.length;
            region.proven = true;
            region.pair = piece.pair;
        }
    }
    region.position = origin + position / weight;
    const float norm = direction.norm();
    region.normal = norm > 1e-6F * weight ? Vector3f(direction / norm) : pieces.places.direction(members.front());
    float squares = 0;
    float depth = 0;
    float open = 0;
    for (const std::uint32_t i : members) {
        const CurvePiece& piece = all[pieces.source[i]];
        const float w = pieces.weight[i] / weight;
        const Vector3f arm = piece.position - region.position;
        const float along = arm.dot(region.normal);
        const float squaredArm = arm.squaredNorm();
        const float squaredExtent = piece.extent * piece.extent;
        // Two of its three directions are across the normal.
        const float radius = std::sqrt(std::max(squaredArm - along * along, 0.0F) + 2.0F / 3 * squaredExtent);
        squares += w * (squaredArm + squaredExtent);
        depth += w * radius * piece.slope;
        open += piece.proven() ? 0 : w * w * squaredExtent;
    }
    region.extent = std::sqrt(squares);
    region.depth = depth;
    region.positionError = std::sqrt(open);
    region.steps = stepsOf(steps, members.size(), pieces.source.size());
    region.probability = region.proven
                             ? 1
                             : std::clamp(probabilityOfRegion(calibration, std::max(region.rate, 1e-30F), region.steps),
                                          1e-6F, 1 - 1e-6F);
    return region;
}

}  // namespace

void groupCrossing(std::span<const CurvePiece> all, std::uint64_t steps, const RegionSettings& settings,
                   const Calibration& calibration, std::vector<CrossingRegion>& out) {
    assert(settings.spacing > 0.0F);
    thread_local Pieces pieces;
    thread_local std::vector<std::uint32_t> component;
    thread_local std::vector<std::uint32_t> members;
    out.clear();
    pieces.take(all, settings.spacing);
    detail::FloodPieces& places = pieces.places;
    for (std::uint32_t first = 0; first < places.size();) {
        if (!places.isCandidate(first)) {
            ++first;
            continue;
        }
        places.flood(first, settings.spacing, nullptr, 0, component);
        Vector3f axis = Vector3f::Zero();
        for (const std::uint32_t i : component) {
            axis += pieces.weight[i] * all[pieces.source[i]].direction;
        }
        axis.stableNormalize();
        if (std::ranges::all_of(
                component, [&](std::uint32_t i) { return places.direction(i).dot(axis) >= settings.normalCone; })) {
            out.push_back(summary(all, pieces, component, steps, calibration));
            continue;
        }
        std::ranges::for_each(component, [&](std::uint32_t i) { places.makeCandidate(i); });
        std::size_t seed = heaviest(pieces, component, axis, settings.normalCone);
        if (seed == component.size()) {  // they cancel
            seed = heaviest(pieces, component, axis, -2);
            axis = places.direction(component[seed]);
        }
        places.flood(component[seed], settings.spacing, &axis, settings.normalCone, members);
        out.push_back(summary(all, pieces, members, steps, calibration));
    }
    std::ranges::sort(out, std::ranges::greater(), &CrossingRegion::length);
}

namespace {

/// Nearly a standard normal number, within +-3.5; the same on every machine. Uses four draws.
float normalNumber(const RandomKey& key, std::uint32_t draw) {
    float sum = -2;
    for (std::uint32_t i = 0; i < 4; ++i) {
        sum += randomUnit(key, draw + i);
    }
    return 1.7320508F * sum;  // the variance of a uniform number is 1 / 12
}

}  // namespace

void takeRegions(Answer answer, const RandomKey& episode, std::vector<CrossingRegion>& regions) {
    constexpr std::uint32_t firstDraw = 0x72656700;  // apart from all other draws of the pair
    constexpr std::uint32_t drawsPerRegion = 16;
    std::uint32_t draw = firstDraw;
    std::size_t kept = 0;
    for (CrossingRegion& region : regions) {
        const bool take =
            region.proven || (answer == Answer::mostLikely ? region.probability >= 0.5F
                                                           : randomUnit(episode, draw) < region.probability);
        if (take && !region.proven && answer == Answer::sample) {
            const float perAxis = region.positionError / 1.7320508F;
            for (std::uint32_t axis = 0; axis < 3; ++axis) {
                region.position[static_cast<int>(axis)] += perAxis * normalNumber(episode, draw + 1 + 4 * axis);
            }
        }
        draw += drawsPerRegion;
        if (take) {
            regions[kept++] = region;
        }
    }
    regions.resize(kept);
}

}  // namespace grapeshot
