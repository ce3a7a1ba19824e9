#include <grapeshot/narrowphase/contact_set.hpp>

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <set>

#include "support/poses.hpp"

namespace grapeshot {
namespace {

using Eigen::Vector3f;
using test::Random;

const ContactSetSettings defaults;

/// The floor y = 0 is A; B stands on it with the points `feet` (B's frame).
std::vector<SurfaceContact> onFloor(const std::vector<Vector3f>& feet, const Pose& bInA, float maxDistance = 0.06F) {
    std::vector<SurfaceContact> contacts;
    for (const Vector3f& foot : feet) {
        SurfaceContact contact;
        contact.onB = apply(bInA, foot);
        contact.onA = {contact.onB.x(), 0, contact.onB.z()};
        contact.normal = -Vector3f::UnitY();
        contact.signedDistance = contact.onB.y();
        if (contact.signedDistance <= maxDistance) {
            contacts.push_back(contact);
        }
    }
    return contacts;
}

/// The same on a floor of many small steps, rising along x and z: no two places in one plane.
std::vector<SurfaceContact> onSteps(const std::vector<Vector3f>& feet) {
    std::vector<SurfaceContact> contacts = onFloor(feet, {});
    for (SurfaceContact& contact : contacts) {
        const float height = 0.05F * contact.onB.x() + 0.11F * contact.onB.z();
        contact.onA.y() += height;
        contact.onB.y() += height;
    }
    return contacts;
}

/// Underside of a tessellated block.
std::vector<Vector3f> gridFoot(float halfX, float halfZ, int cells) {
    std::vector<Vector3f> feet;
    for (int i = 0; i <= cells; ++i) {
        for (int j = 0; j <= cells; ++j) {
            feet.emplace_back(halfX * (2.0F * static_cast<float>(i) / static_cast<float>(cells) - 1), 0,
                              halfZ * (2.0F * static_cast<float>(j) / static_cast<float>(cells) - 1));
        }
    }
    return feet;
}

Pose posedAt(const Vector3f& translation, const Eigen::AngleAxisf& turn = Eigen::AngleAxisf::Identity()) {
    return {turn.toRotationMatrix(), translation};
}

void shuffle(std::vector<SurfaceContact>& contacts, Random& random) {
    for (std::size_t i = contacts.size(); i > 1; --i) {
        std::swap(contacts[i - 1], contacts[random.bits() % i]);
    }
}

void step(ContactSet& set, const std::vector<SurfaceContact>& contacts, const Pose& bInA,
          const ContactSetSettings& settings = defaults, bool complete = true) {
    refresh(set, bInA, settings);
    merge(set, contacts, bInA, complete, settings);
}

std::vector<PersistentPoint> pointsOf(const ContactSet& set) {
    std::vector<PersistentPoint> points;
    for (const RegionSlot& slot : set.slots) {
        points.insert(points.end(), slot.points.begin(), slot.points.begin() + slot.count);
    }
    return points;
}

std::vector<std::uint32_t> idsOf(const ContactSet& set) {
    std::vector<std::uint32_t> ids;
    for (const RegionSlot& slot : set.slots) {
        if (slot.id != 0) {
            ids.push_back(slot.id);
        }
    }
    return ids;
}

bool sameBytes(const ContactSet& left, const ContactSet& right) {
    return left.nextId == right.nextId && left.droppedRegions == right.droppedRegions &&
           left.slots.size() == right.slots.size() &&
           std::memcmp(left.slots.data(), right.slots.data(), left.slots.size() * sizeof(RegionSlot)) == 0;
}

/// Each is within `tolerance` of one of the expected places in B's frame, and each of those is used once.
void expectFeet(const ContactSet& set, std::vector<Vector3f> expected, float tolerance = 1e-4F) {
    const auto points = pointsOf(set);
    ASSERT_EQ(points.size(), expected.size());
    for (const PersistentPoint& point : points) {
        const auto match = std::find_if(expected.begin(), expected.end(),
                                        [&](const Vector3f& foot) { return (foot - point.localB).norm() < tolerance; });
        ASSERT_NE(match, expected.end()) << point.localB.transpose();
        expected.erase(match);
    }
}

const std::vector<Vector3f> corners = {{-0.5F, 0, -0.3F}, {-0.5F, 0, 0.3F}, {0.5F, 0, -0.3F}, {0.5F, 0, 0.3F}};

TEST(ContactSet, KeepsTheFourCornersOfATessellatedFoot) {
    Random random(1);
    for (const int cells : {1, 2, 3, 8, 20, 25}) {
        for (int trial = 0; trial < 10; ++trial) {
            const Pose pose = posedAt({0.3F, 0.004F, -0.2F},
                                      Eigen::AngleAxisf(static_cast<float>(random.uniform(0, 6)), Vector3f::UnitY()));
            auto contacts = onFloor(gridFoot(0.5F, 0.3F, cells), pose);
            shuffle(contacts, random);
            ContactSet set;
            RegionSettings wide;
            wide.spacing = 1.1F;
            ContactSetSettings settings;
            settings.regions = wide;
            step(set, contacts, pose, settings);
            expectFeet(set, corners);
        }
    }
}

TEST(ContactSet, IsQuietAtRestUnderNoise) {
    Random random(2);
    const auto feet = gridFoot(0.5F, 0.3F, 20);
    ContactSet set;
    for (int i = 0; i < 200; ++i) {
        const auto noise = [&] { return static_cast<float>(random.uniform(-3e-4, 3e-4)); };
        const Pose pose = posedAt({noise(), 0.002F + noise(), noise()}, Eigen::AngleAxisf(noise(), random.direction()));
        auto contacts = onFloor(feet, pose);
        shuffle(contacts, random);
        step(set, contacts, pose);
        ASSERT_EQ(idsOf(set), std::vector<std::uint32_t>{1});
        expectFeet(set, corners);
        for (const PersistentPoint& point : pointsOf(set)) {
            EXPECT_EQ(point.age, static_cast<std::uint32_t>(i));
        }
    }
}

TEST(ContactSet, ALineGivesItsEnds) {
    std::vector<Vector3f> feet;
    for (int i = 0; i <= 40; ++i) {
        feet.emplace_back(static_cast<float>(i) * 0.02F - 0.4F, 1e-5F * static_cast<float>(i % 3), 0);
    }
    for (const float angle : {0.0F, 0.7F, 1.9F}) {
        const Pose pose = posedAt({0, 0, 0}, Eigen::AngleAxisf(angle, Vector3f::UnitY()));
        ContactSet set;
        step(set, onFloor(feet, pose), pose);
        expectFeet(set, {feet.front(), feet.back()});
    }
}

TEST(ContactSet, PointsAreApartAndTheDeepestIsAmongThem) {
    Random random(3);
    int crowded = 0;
    for (int trial = 0; trial < 300; ++trial) {
        ContactSet set;
        std::vector<Vector3f> feet;
        const double extent = random.uniform(0.005, 0.3);
        const std::size_t count = 1 + random.bits() % 60;
        for (std::size_t i = 0; i < count; ++i) {
            feet.emplace_back(random.uniform(-extent, extent), random.uniform(-0.03, 0.05),
                              random.uniform(-extent, extent));
        }
        for (int i = 0; i < 6; ++i) {
            // Sliding, so that kept points meet new ones.
            const Pose pose =
                posedAt({static_cast<float>(i) * 0.004F, static_cast<float>(random.uniform(-0.01, 0.01)), 0},
                        Eigen::AngleAxisf(static_cast<float>(random.uniform(-0.05, 0.05)), random.direction()));
            const auto contacts = onFloor(feet, pose, 0.08F);
            step(set, contacts, pose);
            std::vector<ContactRegion> regions = groupRegions(contacts, defaults.regions);
            float deepest = std::numeric_limits<float>::max();
            for (const RegionSlot& slot : set.slots) {
                for (int p = 0; p < slot.count; ++p) {
                    const auto& point = slot.points[static_cast<std::size_t>(p)];
                    deepest = std::min(deepest, point.signedDistance);
                    for (int q = 0; q < p; ++q) {
                        EXPECT_GE((slot.points[static_cast<std::size_t>(q)].localA - point.localA).norm(),
                                  defaults.mergeDistance * 0.9999F);
                        ++crowded;
                    }
                }
            }
            if (!contacts.empty()) {
                EXPECT_LE(deepest, -regions.front().depth + 0.1001F * defaults.mergeDistance);
            }
        }
    }
    EXPECT_GT(crowded, 1000);
}

/// Area of the hull of four points of the plane y = 0.
double hullArea(const Vector3f& a, const Vector3f& b, const Vector3f& c, const Vector3f& d) {
    const auto cross = [](const Vector3f& p, const Vector3f& q, const Vector3f& r, const Vector3f& s) {
        return std::abs((q - p).cast<double>().cross((s - r).cast<double>()).norm()) / 2;
    };
    return std::max({cross(a, b, a, c), cross(a, b, a, d), cross(a, c, a, d), cross(b, c, b, d), cross(a, b, c, d),
                     cross(a, c, b, d), cross(a, d, b, c)});
}

TEST(ContactSet, SupportIsNearlyTheWidestPossible) {
    Random random(4);
    double sum = 0, worst = 1;
    const int trials = 200;
    for (int trial = 0; trial < trials; ++trial) {
        std::vector<Vector3f> feet;
        for (int i = 0; i < 14; ++i) {
            feet.emplace_back(random.uniform(-0.4, 0.4), 0, random.uniform(-0.4, 0.4));
        }
        double best = 0;
        for (std::size_t i = 0; i < feet.size(); ++i) {
            for (std::size_t j = 0; j < i; ++j) {
                for (std::size_t k = 0; k < j; ++k) {
                    for (std::size_t l = 0; l < k; ++l) {
                        best = std::max(best, hullArea(feet[i], feet[j], feet[k], feet[l]));
                    }
                }
            }
        }
        ContactSetSettings settings;
        settings.regions.spacing = 2;
        ContactSet set;
        step(set, onFloor(feet, {}), {}, settings);
        const auto p = pointsOf(set);
        ASSERT_GE(p.size(), 3U);
        const double area = hullArea(p[0].localA, p[1].localA, p[2].localA, p.back().localA);
        sum += area / best;
        worst = std::min(worst, area / best);
    }
    EXPECT_GT(sum / trials, 0.98);
    EXPECT_GT(worst, 0.85);
}

TEST(ContactSet, ATableStandsOnItsFootNotOnShorterLegs) {
    std::vector<Vector3f> feet = gridFoot(0.1F, 0.1F, 2);
    for (const float x : {-0.5F, 0.5F}) {
        for (const float z : {-0.5F, 0.5F}) {
            feet.emplace_back(x, 0.02F, z);
        }
    }
    ContactSetSettings settings;
    settings.regions.spacing = 1;
    ContactSet set;
    const Pose level = posedAt({0, 0.001F, 0});
    step(set, onFloor(feet, level), level, settings);
    expectFeet(set, {{-0.1F, 0, -0.1F}, {-0.1F, 0, 0.1F}, {0.1F, 0, -0.1F}, {0.1F, 0, 0.1F}});
    // Nothing changes by a tilt of a thousandth.
    const ContactSet before = set;
    const Pose tilted = posedAt({0, 0.001F, 0}, Eigen::AngleAxisf(1e-3F, Vector3f::UnitX()));
    step(set, onFloor(feet, tilted), tilted, settings);
    expectFeet(set, {{-0.1F, 0, -0.1F}, {-0.1F, 0, 0.1F}, {0.1F, 0, -0.1F}, {0.1F, 0, 0.1F}});
    EXPECT_EQ(idsOf(set), idsOf(before));
}

TEST(ContactSet, ATiltedFootKeepsItsFarEdge) {
    // The far edge hangs 3 mm above the floor: still one face.
    const auto feet = gridFoot(0.5F, 0.3F, 20);
    const Pose tilted = posedAt({0, 0.0015F, 0}, Eigen::AngleAxisf(0.003F, Vector3f::UnitZ()));
    ContactSet set;
    step(set, onFloor(feet, tilted), tilted);
    expectFeet(set, corners);
}

TEST(ContactSet, ASlidingBlockKeepsNamesCornersAndAges) {
    const auto feet = gridFoot(0.5F, 0.3F, 40);  // cells of 0.025 and 0.015: shorter and longer than a step
    for (const float speed : {0.004F, 0.015F, 0.019F}) {
        ContactSet set;
        for (int i = 0; i < 100; ++i) {
            const Pose pose = posedAt({speed * static_cast<float>(i), 0.001F, 0.3F * speed * static_cast<float>(i)});
            step(set, onFloor(feet, pose), pose);
            ASSERT_EQ(idsOf(set), std::vector<std::uint32_t>{1});
            expectFeet(set, corners);
            if (speed < 0.019F) {
                for (const PersistentPoint& point : pointsOf(set)) {
                    EXPECT_EQ(point.age, static_cast<std::uint32_t>(i));
                }
            }
        }
    }
}

TEST(ContactSet, AFastBlockKeepsItsSlotThoughItsPointsGo) {
    const auto feet = gridFoot(0.5F, 0.3F, 20);
    ContactSet set;
    for (int i = 0; i < 50; ++i) {
        const Pose pose = posedAt({0.2F * static_cast<float>(i), 0, 0});
        refresh(set, pose, defaults);
        if (i > 0) {
            EXPECT_TRUE(pointsOf(set).empty()) << "slid by ten times mergeDistance";
        }
        merge(set, onFloor(feet, pose), pose, true, defaults);
        ASSERT_EQ(idsOf(set), std::vector<std::uint32_t>{1});
        expectFeet(set, corners);
    }
}

TEST(ContactSet, ARockingBlockKeepsNames) {
    const auto feet = gridFoot(0.5F, 0.3F, 20);
    ContactSet set;
    std::size_t fewest = 9;
    for (int i = 0; i < 300; ++i) {
        const float angle = 0.1F * std::sin(0.11F * static_cast<float>(i));
        const float lift = 0.5F * std::abs(std::sin(angle));
        const Pose pose = posedAt({0, lift, 0}, Eigen::AngleAxisf(angle, Vector3f::UnitZ()));
        step(set, onFloor(feet, pose), pose);
        ASSERT_EQ(idsOf(set), std::vector<std::uint32_t>{1}) << "step " << i;
        const std::size_t count = pointsOf(set).size();
        fewest = std::min(fewest, count);
        EXPECT_TRUE(count >= 2 && count <= 4);
    }
    EXPECT_LT(fewest, 5U);
}

TEST(ContactSet, RegionsThatSplitAndJoinDoNotFlicker) {
    // Two feet, and a bridge between them that is seen every other step.
    std::vector<Vector3f> feet = gridFoot(0.045F, 0.045F, 1);
    for (Vector3f& foot : feet) {
        foot.x() -= 0.13F;
    }
    for (const Vector3f& foot : gridFoot(0.045F, 0.045F, 1)) {
        feet.push_back(foot + Vector3f(0.13F, 0, 0));
    }
    std::vector<Vector3f> bridged = feet;
    bridged.emplace_back(0, 0, 0.05F);
    ASSERT_EQ(groupRegions(onSteps(feet), defaults.regions).size(), 2U);
    ASSERT_EQ(groupRegions(onSteps(bridged), defaults.regions).size(), 1U);
    for (const bool bridgedFirst : {false, true}) {
        ContactSet set;
        std::set<std::vector<std::uint32_t>> names;
        for (int i = 0; i < 40; ++i) {
            step(set, onSteps((i % 2 == 0) == bridgedFirst ? bridged : feet), {});
            if (i > 3) {
                names.insert(idsOf(set));
            }
        }
        EXPECT_EQ(names.size(), 1U);
        EXPECT_LE(set.nextId, 3U);
    }
}

TEST(ContactSet, RefreshReevaluatesAlongTheNormalThatTurnsWithB) {
    Random random(5);
    const auto feet = gridFoot(0.2F, 0.2F, 4);
    int kept = 0, dropped = 0;
    for (int trial = 0; trial < 200; ++trial) {
        ContactSet set;
        merge(set, onFloor(feet, {}), {}, true, defaults);
        ContactSet before = set;
        const Pose pose = posedAt(static_cast<float>(random.uniform(0, 0.05)) * random.direction(),
                                  Eigen::AngleAxisf(static_cast<float>(random.uniform(0, 0.2)), random.direction()));
        refresh(set, pose, defaults);
        std::size_t found = 0;
        for (const PersistentPoint& old : pointsOf(before)) {
            const Vector3f normal = pose.rotation * old.normalInB;
            const Vector3f apart = old.localA - apply(pose, old.localB);
            const float distance = normal.dot(apart);
            const bool stays =
                distance <= defaults.maxDistance && (apart - distance * normal).norm() <= defaults.mergeDistance;
            (stays ? kept : dropped) += 1;
            for (const PersistentPoint& now : pointsOf(set)) {
                if (now.localA == old.localA) {
                    EXPECT_TRUE(stays);
                    EXPECT_NEAR(now.signedDistance, distance, 1e-6);
                    EXPECT_EQ(now.age, old.age + 1);
                    ++found;
                }
            }
        }
        EXPECT_EQ(found, pointsOf(set).size());
    }
    EXPECT_GT(kept, 100);
    EXPECT_GT(dropped, 100);
}

TEST(ContactSet, PointsWithoutCounterpartGoOnlyIfAllContactsAreKnown) {
    const auto feet = gridFoot(0.5F, 0.3F, 1);
    const auto half = std::vector<Vector3f>{feet[0], feet[1]};
    for (const bool complete : {true, false}) {
        ContactSet set;
        step(set, onFloor(feet, {}), {});
        step(set, onFloor(half, {}), {}, defaults, complete);
        std::size_t all = pointsOf(set).size();
        EXPECT_EQ(all, complete ? 2U : 4U);
        step(set, {}, {}, defaults, complete);
        EXPECT_EQ(pointsOf(set).size(), complete ? 0U : 4U);
        EXPECT_EQ(idsOf(set).empty(), complete);
        // Evidence is not for ever.
        refresh(set, posedAt({0, 0.1F, 0}), defaults);
        merge(set, {}, posedAt({0, 0.1F, 0}), false, defaults);
        EXPECT_TRUE(idsOf(set).empty());
    }
}

TEST(ContactSet, AnOldPointOnNewGeometryKeepsItsAge) {
    ContactSet set;
    const std::vector<Vector3f> first = {{0, 0, 0}};
    const std::vector<Vector3f> moved = {{0.015F, 0.001F, 0}};
    step(set, onFloor(first, {}), {});
    for (int i = 0; i < 5; ++i) {
        step(set, onFloor(first, {}), {});
    }
    step(set, onFloor(moved, {}), {});
    expectFeet(set, moved);
    EXPECT_EQ(pointsOf(set)[0].age, 6U);
    // Another direction is another contact, however near.
    auto turned = onFloor(moved, {});
    turned[0].normal = Vector3f::UnitX();
    turned[0].onA = turned[0].onB + turned[0].signedDistance * turned[0].normal;
    step(set, turned, {});
    ASSERT_EQ(pointsOf(set).size(), 1U);
    EXPECT_EQ(pointsOf(set)[0].age, 0U);
    EXPECT_EQ(idsOf(set), std::vector<std::uint32_t>{2});
}

TEST(ContactSet, DeeperPointsReplaceKeptOnesWithoutTheirPlaces) {
    const std::vector<Vector3f> feet = gridFoot(0.3F, 0.3F, 1);
    std::vector<Vector3f> bulged = feet;
    bulged.emplace_back(0.02F, -0.004F, 0);  // in the middle, deeper by a fifth of mergeDistance
    ContactSetSettings settings;
    settings.regions.spacing = 1;
    ContactSet set;
    step(set, onFloor(feet, {}), {}, settings);
    ASSERT_EQ(pointsOf(set).size(), 4U);
    for (int i = 0; i < 3; ++i) {
        step(set, onFloor(bulged, {}), {}, settings);
        const auto points = pointsOf(set);
        EXPECT_EQ(points.size(), 4U);
        EXPECT_TRUE(std::any_of(points.begin(), points.end(),
                                [](const PersistentPoint& point) { return point.signedDistance == -0.004F; }));
    }
    bulged.back().y() = -0.001F;  // not clearly deeper: the corners stay
    ContactSet corner;
    step(corner, onFloor(feet, {}), {}, settings);
    step(corner, onFloor(bulged, {}), {}, settings);
    expectFeet(corner, feet);
}

/// Twelve contacts that face the twelve corners of an icosahedron: no two of them belong together.
std::vector<SurfaceContact> twelveDirections() {
    std::vector<SurfaceContact> contacts;
    const float golden = 1.618034F;
    for (int i = 0; i < 12; ++i) {
        Vector3f direction(0, i % 2 == 0 ? 1.0F : -1.0F, i / 2 % 2 == 0 ? golden : -golden);
        std::rotate(direction.data(), direction.data() + i / 4, direction.data() + 3);
        SurfaceContact contact;
        contact.normal = direction.normalized();
        contact.signedDistance = 0.001F * static_cast<float>((i * 5) % 12);
        contact.onB = -contact.normal;
        contact.onA = contact.onB + contact.signedDistance * contact.normal;
        contacts.push_back(contact);
    }
    return contacts;
}

TEST(ContactSet, BeyondTheCapTheShallowestAreLeftOutAndCounted) {
    auto contacts = twelveDirections();
    ContactSet set;
    step(set, contacts, {});
    EXPECT_EQ(set.droppedRegions, 4U);
    EXPECT_EQ(idsOf(set).size(), 8U);
    for (const PersistentPoint& point : pointsOf(set)) {
        EXPECT_LT(point.signedDistance, 0.0075F);
    }
    // One that comes a little closer than another does not push it out; one much deeper does.
    const auto before = idsOf(set);
    const auto last = std::max_element(contacts.begin(), contacts.end(), [](const auto& left, const auto& right) {
        return left.signedDistance < right.signedDistance;
    });
    last->signedDistance = 0.006F;
    last->onA = last->onB + last->signedDistance * last->normal;
    step(set, contacts, {});
    EXPECT_EQ(idsOf(set), before);
    last->signedDistance = -0.02F;
    last->onA = last->onB + last->signedDistance * last->normal;
    step(set, contacts, {});
    EXPECT_EQ(idsOf(set).size(), 8U);
    EXPECT_NE(idsOf(set), before);
    EXPECT_EQ(set.droppedRegions, 4U);
}

TEST(ContactSet, AFootInManyPiecesKeepsItsSupportUnderTheCap) {
    const auto feet = gridFoot(1, 1, 5);  // 0.4 apart: 36 regions
    ASSERT_EQ(groupRegions(onSteps(feet), defaults.regions).size(), 36U);
    ContactSet set;
    std::vector<std::uint32_t> first;
    for (int i = 0; i < 5; ++i) {
        step(set, onSteps(feet), {});
        first = i == 0 ? idsOf(set) : first;
        EXPECT_EQ(idsOf(set), first);
        EXPECT_EQ(first.size(), 8U);
        EXPECT_EQ(set.droppedRegions, 0U);
        for (const Vector3f& corner : gridFoot(1, 1, 1)) {
            const auto points = pointsOf(set);
            EXPECT_TRUE(std::any_of(points.begin(), points.end(), [&](const PersistentPoint& point) {
                return std::hypot(point.localB.x() - corner.x(), point.localB.z() - corner.z()) < 1e-4F &&
                       point.age == static_cast<std::uint32_t>(i);
            }));
        }
    }
}

TEST(ContactSet, NamesAreNeverReused) {
    Random random(6);
    ContactSet set;
    std::set<std::uint32_t> gone;
    std::vector<std::uint32_t> before;
    for (int i = 0; i < 500; ++i) {
        std::vector<Vector3f> feet;
        for (int place = 0; place < 6; ++place) {
            if (random.unit() < 0.7) {
                feet.emplace_back(static_cast<float>(place) * 2, 0, 0);
            }
        }
        step(set, onSteps(feet), {});
        const auto now = idsOf(set);
        EXPECT_EQ(now.size(), feet.size());
        for (const std::uint32_t id : now) {
            EXPECT_EQ(gone.count(id), 0U);
        }
        for (const std::uint32_t id : before) {
            if (std::find(now.begin(), now.end(), id) == now.end()) {
                gone.insert(id);
            }
        }
        before = now;
    }
    EXPECT_GT(gone.size(), 100U);
    EXPECT_LE(set.slots.size(), 6U);
}

TEST(ContactSet, IsAValueSameBytesAndContinuesFromACopy) {
    const auto run = [](ContactSet set, int from, int to, std::uint64_t seed) {
        for (int i = from; i < to; ++i) {
            Random random(seed + static_cast<std::uint64_t>(i));
            const auto feet = gridFoot(0.5F, 0.3F, 12);
            const Pose pose =
                posedAt({0.01F * static_cast<float>(i), static_cast<float>(random.uniform(-0.01, 0.03)), 0},
                        Eigen::AngleAxisf(static_cast<float>(random.uniform(0, 0.1)), random.direction()));
            step(set, onFloor(feet, pose), pose, defaults, i % 5 != 0);
        }
        return set;
    };
    const ContactSet whole = run({}, 0, 60, 7);
    EXPECT_FALSE(pointsOf(whole).empty());
    EXPECT_TRUE(sameBytes(whole, run({}, 0, 60, 7)));
    EXPECT_TRUE(sameBytes(whole, run(run({}, 0, 23, 7), 23, 60, 7)));
    EXPECT_FALSE(sameBytes(whole, run({}, 0, 59, 7)));
}

TEST(ContactSet, ABallRollingInABowlKeepsOneName) {
    // A is a bowl of radius 1 about the origin, B a ball of radius 0.3 in it; both rows of samples on the ball.
    ContactSet set;
    for (int i = 0; i < 200; ++i) {
        const float angle = 0.8F * std::sin(0.03F * static_cast<float>(i));
        const Vector3f center = 0.7F * Vector3f(std::sin(angle), -std::cos(angle), 0);
        const Pose pose = posedAt(center, Eigen::AngleAxisf(-2.3F * angle, Vector3f::UnitZ()));
        std::vector<SurfaceContact> contacts;
        for (int u = -6; u <= 6; ++u) {
            for (int v = -6; v <= 6; ++v) {
                const Vector3f out = (center.normalized() + 0.04F * static_cast<float>(u) * Vector3f::UnitZ() +
                                      0.04F * static_cast<float>(v) * center.cross(Vector3f::UnitZ()).normalized())
                                         .normalized();
                SurfaceContact contact;
                contact.onB = center + 0.3F * out;
                contact.onA = contact.onB.normalized();
                contact.signedDistance = (contact.onA - contact.onB).norm();
                contact.normal = contact.onA.normalized();
                contact.onA = contact.onB + contact.signedDistance * contact.normal;
                contacts.push_back(contact);
            }
        }
        step(set, contacts, pose);
        ASSERT_EQ(idsOf(set), std::vector<std::uint32_t>{1}) << "step " << i;
        EXPECT_LE(pointsOf(set).size(), 4U);
    }
}

}  // namespace
}  // namespace grapeshot
