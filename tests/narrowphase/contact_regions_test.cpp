#include <grapeshot/narrowphase/contact_regions.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <queue>

#include "support/poses.hpp"

namespace grapeshot {
namespace {

using test::Random;

/// A contact of surfaces `gap` apart at a place, with a given normal.
SurfaceContact contactAt(const Eigen::Vector3f& place, const Eigen::Vector3f& normal, float gap) {
    SurfaceContact contact;
    contact.normal = normal.normalized();
    contact.onB = place - 0.5F * gap * contact.normal;
    contact.onA = contact.onB + gap * contact.normal;
    contact.signedDistance = gap;
    return contact;
}

/// Patches here and there, with normals that scatter by about `scatter`.
std::vector<SurfaceContact> randomContacts(std::size_t count, double extent, float scatter, Random& random) {
    std::vector<SurfaceContact> contacts;
    std::vector<Eigen::Vector3f> normals = {random.direction(), random.direction(), random.direction()};
    for (std::size_t i = 0; i < count; ++i) {
        const Eigen::Vector3f place(static_cast<float>(random.uniform(-extent, extent)),
                                    static_cast<float>(random.uniform(-extent, extent)),
                                    static_cast<float>(random.uniform(-extent, extent)));
        const Eigen::Vector3f& face = normals[random.bits() % normals.size()];
        const auto gap = static_cast<float>(random.uniform(-0.01, 0.03));
        if (random.bits() % 4 == 0) {  // on a flat face of B through the origin
            contacts.push_back(contactAt(place - face.dot(place) * face + 0.5F * gap * face, face, gap));
        } else {
            contacts.push_back(contactAt(place, face + scatter * random.direction(), gap));
        }
    }
    return contacts;
}

/// The definition, word for word, in O(n^2).
std::vector<std::vector<std::uint32_t>> regionsByDefinition(const std::vector<SurfaceContact>& contacts,
                                                            const RegionSettings& settings) {
    std::vector<std::uint32_t> order(contacts.size());
    std::iota(order.begin(), order.end(), 0U);
    std::sort(order.begin(), order.end(),
              [&](auto l, auto r) { return contacts[l].signedDistance < contacts[r].signedDistance; });
    std::vector<char> taken(contacts.size(), 0);
    std::vector<std::vector<std::uint32_t>> regions;
    for (const std::uint32_t seed : order) {
        if (taken[seed] != 0) {
            continue;
        }
        std::vector<std::uint32_t> members = {seed};
        taken[seed] = 1;
        for (std::uint32_t other = 0; other < contacts.size(); ++other) {
            const auto height = [&](const Eigen::Vector3f& to, const Eigen::Vector3f& from) {
                return std::abs((to - from).dot(contacts[seed].normal));
            };
            if (taken[other] == 0 && contacts[other].normal.dot(contacts[seed].normal) >= flatCone &&
                std::min(height(contacts[other].onA, contacts[seed].onA),
                         height(contacts[other].onB, contacts[seed].onB)) <= flatHeight * settings.spacing) {
                taken[other] = 1;
                members.push_back(other);
            }
        }
        for (std::size_t at = 0; at < members.size(); ++at) {
            for (std::uint32_t other = 0; other < contacts.size(); ++other) {
                if (taken[other] == 0 && (contacts[other].onA - contacts[members[at]].onA).norm() <= settings.spacing &&
                    (contacts[other].onB - contacts[members[at]].onB).norm() <= settings.spacing &&
                    contacts[other].normal.dot(contacts[seed].normal) >= settings.normalCone) {
                    taken[other] = 1;
                    members.push_back(other);
                }
            }
        }
        std::sort(members.begin(), members.end());
        regions.push_back(members);
    }
    return regions;
}

std::vector<std::vector<std::uint32_t>> sortedMembers(const std::vector<ContactRegion>& regions) {
    std::vector<std::vector<std::uint32_t>> all;
    for (const ContactRegion& region : regions) {
        all.push_back(region.members);
        std::sort(all.back().begin(), all.back().end());
    }
    return all;
}

TEST(ContactRegions, AreThoseOfTheDefinition) {
    Random random(1);
    std::size_t several = 0, shared = 0;
    for (int trial = 0; trial < 200; ++trial) {
        const std::size_t count = 1 + random.bits() % 150;
        const auto contacts = randomContacts(count, random.uniform(0.05, 1.0), 0.3F, random);
        const RegionSettings settings;
        const auto regions = groupRegions(contacts, settings);
        EXPECT_EQ(sortedMembers(regions), regionsByDefinition(contacts, settings));
        several += regions.size() > 1 ? 1U : 0U;
        shared += regions.size() < contacts.size() ? 1U : 0U;
    }
    EXPECT_GT(several, 100U);
    EXPECT_GT(shared, 100U);
}

TEST(ContactRegions, HoldEachContactOnceDeepestFirst) {
    Random random(2);
    for (int trial = 0; trial < 50; ++trial) {
        const auto contacts = randomContacts(300, 0.4, 0.2F, random);
        const auto regions = groupRegions(contacts, {});
        std::vector<std::uint32_t> all;
        for (std::size_t r = 0; r < regions.size(); ++r) {
            const auto& members = regions[r].members;
            ASSERT_FALSE(members.empty());
            EXPECT_TRUE(std::is_sorted(members.begin(), members.end(), [&](auto left, auto right) {
                return contacts[left].signedDistance < contacts[right].signedDistance;
            }));
            EXPECT_EQ(regions[r].depth, -contacts[members.front()].signedDistance);
            EXPECT_TRUE(r == 0 || regions[r - 1].depth >= regions[r].depth);
            EXPECT_NEAR(regions[r].normal.norm(), 1, 1e-5);
            EXPECT_GE(regions[r].normal.dot(contacts[members.front()].normal), 0.866F);
            all.insert(all.end(), members.begin(), members.end());
        }
        std::sort(all.begin(), all.end());
        EXPECT_EQ(all.size(), contacts.size());
        EXPECT_EQ(std::unique(all.begin(), all.end()), all.end());
    }
}

TEST(ContactRegions, DoNotDependOnTheOrderOfTheContacts) {
    Random random(3);
    for (int trial = 0; trial < 50; ++trial) {
        auto contacts = randomContacts(120, 0.3, 0.2F, random);
        // Ties in depth, as on flat faces.
        for (SurfaceContact& contact : contacts) {
            contact = contactAt(contact.onB, contact.normal, 0.01F);
        }
        const auto before = groupRegions(contacts, {});
        std::vector<std::uint32_t> order(contacts.size());
        std::iota(order.begin(), order.end(), 0U);
        for (std::size_t i = order.size(); i > 1; --i) {
            std::swap(order[i - 1], order[random.bits() % i]);
        }
        std::vector<SurfaceContact> shuffled;
        for (const std::uint32_t i : order) {
            shuffled.push_back(contacts[i]);
        }
        const auto after = groupRegions(shuffled, {});
        ASSERT_EQ(before.size(), after.size());
        for (std::size_t r = 0; r < before.size(); ++r) {
            EXPECT_EQ(before[r].normal, after[r].normal);
            EXPECT_EQ(before[r].center, after[r].center);
            std::vector<std::uint32_t> translated;
            for (const std::uint32_t member : after[r].members) {
                translated.push_back(order[member]);
            }
            EXPECT_EQ(before[r].members, translated);
        }
    }
}

TEST(ContactRegions, NearOnOneSurfaceOnlyIsNotTheSameRegion) {
    // Two fingers of B that touch A at places far apart on B but near on A, and the other way round.
    SurfaceContact first, second;
    first.onA = {0, 0, 0}, first.onB = {0, -0.01F, 0};
    second.onA = {0.05F, 0.01F, 0}, second.onB = {0.5F, 0, 0};
    EXPECT_EQ(groupRegions(std::vector{first, second}, {}).size(), 2U);
    second.onA = {0.5F, 0.01F, 0}, second.onB = {0.05F, 0, 0};
    EXPECT_EQ(groupRegions(std::vector{first, second}, {}).size(), 2U);
    second.onB = {0.05F, 0, 0};
    second.onA = {0.05F, 0.01F, 0};
    EXPECT_EQ(groupRegions(std::vector{first, second}, {}).size(), 1U);
}

TEST(ContactRegions, OneFlatSupportIsOneRegionHoweverFarItsPointsAreApart) {
    std::vector<SurfaceContact> feet;
    for (const float x : {-3.0F, 3.0F}) {
        for (const float z : {-2.0F, 2.0F}) {
            feet.push_back(contactAt({x, 0, z}, {0, 1, 0}, 0));
        }
    }
    EXPECT_EQ(groupRegions(feet, {}).size(), 1U);
    feet.push_back(contactAt({0, 0.5F, 0}, {0, 1, 0}, 0));  // on another step
    feet.push_back(contactAt({0, 0, 9}, {0, -1, 0}, 0));    // from below
    feet.push_back(contactAt({9, 0, 0}, {0.1F, 1, 0}, 0));  // on a slope
    EXPECT_EQ(groupRegions(feet, {}).size(), 4U);
    // Standing askew: the floor is still one plane.
    for (SurfaceContact& foot : feet) {
        foot.signedDistance = 0.01F * foot.onB.x();
        foot.onA = foot.onB + foot.signedDistance * foot.normal;
    }
    EXPECT_EQ(groupRegions(std::span(feet).first(4), {}).size(), 1U);
}

TEST(ContactRegions, FarFromTheOriginAndBadNumbersAreHarmless) {
    EXPECT_TRUE(groupRegions({}, {}).empty());
    std::vector<SurfaceContact> contacts;
    for (int i = 0; i < 100; ++i) {
        contacts.push_back(contactAt({1e15F, static_cast<float>(i) * 1e13F, -1e15F}, {0, 1, 0}, 0));
    }
    std::size_t members = 0;
    for (const auto& region : groupRegions(contacts, {.spacing = 1e-6F})) {
        members += region.members.size();
    }
    EXPECT_EQ(members, contacts.size());
    contacts[3].onA.x() = std::numeric_limits<float>::quiet_NaN();
    contacts[4].normal.y() = std::numeric_limits<float>::infinity();
    contacts[5].signedDistance = std::numeric_limits<float>::quiet_NaN();
    members = 0;
    for (const auto& region : groupRegions(contacts, {})) {
        members += region.members.size();
        EXPECT_TRUE(region.normal.allFinite() && region.center.allFinite());
        EXPECT_THAT(region.members, testing::Not(testing::Contains(testing::AnyOf(3U, 4U, 5U))));
    }
    EXPECT_EQ(members, contacts.size() - 3);
}

}  // namespace
}  // namespace grapeshot
