// Boxes on floors: where simulations are looked at, contacts must be exactly flat, complete, and push the right way.
#include <grapeshot/narrowphase/local_contacts.hpp>

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <scenes/shapes.hpp>
#include <support/poses.hpp>
#include <support/test_size.hpp>

#include "triangle_pairs.hpp"

namespace grapeshot {
namespace {

using Eigen::Matrix3f;
using Eigen::Vector3f;
using test::localContactsOf;
using ContactList = std::vector<SurfaceContact>;

constexpr float flatReach = 0.06F;

Matrix3f yaw(float angle) {
    return Eigen::AngleAxisf(angle, Vector3f::UnitY()).toRotationMatrix();
}

bool isPresent(const ContactList& contacts, const Vector3f& onA, float tolerance) {
    return std::any_of(contacts.begin(), contacts.end(),
                       [&](const SurfaceContact& contact) { return (contact.onA - onA).norm() <= tolerance; });
}

/// Every contact is straight up with the given distance.
void expectFlat(const ContactList& contacts, const Vector3f& up, float gap, const std::string& where) {
    for (const SurfaceContact& contact : contacts) {
        EXPECT_GT(contact.normal.dot(up), 1 - 1e-6F) << where << testing::PrintToString(contact);
        EXPECT_NEAR(contact.signedDistance, gap, 1e-5F) << where << testing::PrintToString(contact);
    }
}

struct Floor {
    const char* name;
    scenes::Mesh mesh;  // its upper side is the plane y = 0
};

std::vector<Floor> floors() {
    const Vector3f half(3, 0.5F, 3);
    return {{"sheet of 2", scenes::grid(3, 3, 1, 1)},
            {"sheet of 200", scenes::grid(3, 3, 10, 10)},
            {"box of 12", scenes::moved(scenes::box(half), {0, -0.5F, 0})},
            {"box of 588", scenes::moved(scenes::box(half, 7), {0, -0.5F, 0})}};
}

// The block's frame is A's; the floor moves under it.
TEST(FlatContacts, ABlockOverOrInAFloorHasItsFourCornersStraightUp) {
    test::Random random(3);
    const Vector3f half(0.5F, 0.25F, 0.4F);
    for (const Floor& floor : floors()) {
        const MeshModel ground = makeModel(floor.mesh.view());
        for (const int cells : {1, 3}) {
            const MeshModel block = makeModel(scenes::box(half, cells).view());
            for (const float gap : {0.05F, 0.01F, 1e-4F, -1e-4F, -0.005F, -0.03F}) {
                for (std::size_t i = 0; i < test::sampleSize(6, 100); ++i) {
                    // Offsets onto the inner edges of the floor first, then anywhere; straight first, then turned.
                    Vector3f at(0, half.y() + gap, 0);
                    if (i >= 2) {
                        at.x() = static_cast<float>(random.uniform(-2, 2));
                        at.z() = static_cast<float>(random.uniform(-2, 2));
                    }
                    const Matrix3f turn =
                        i % 2 == 0 ? Matrix3f(Matrix3f::Identity()) : yaw(static_cast<float>(random.uniform(0, 6.3)));
                    const Pose floorInBlock = inverse({turn, at});
                    const std::string where = std::string(floor.name) + ", cells " + std::to_string(cells) + ", gap " +
                                              std::to_string(gap) + ", sample " + std::to_string(i) + ": ";
                    const ContactList contacts = localContactsOf(block, ground, floorInBlock, flatReach);
                    expectFlat(contacts, Vector3f::UnitY(), gap, where);
                    for (int corner = 0; corner < 4; ++corner) {
                        const Vector3f onA(corner % 2 == 0 ? half.x() : -half.x(), -half.y(),
                                           corner / 2 == 0 ? half.z() : -half.z());
                        EXPECT_TRUE(isPresent(contacts, onA, 1e-4F)) << where << onA.transpose();
                    }
                    const ContactList swapped = localContactsOf(ground, block, {turn, at}, flatReach);
                    expectFlat(swapped, -Vector3f::UnitY(), gap, where + "swapped ");
                    EXPECT_EQ(swapped.size(), contacts.size()) << where;
                }
            }
        }
    }
}

TEST(FlatContacts, SlightlyTiltedFacesGiveAllCornersWithTheFloorsNormal) {
    const Vector3f half(0.5F, 0.25F, 0.5F);
    const MeshModel block = makeModel(scenes::box(half).view());
    for (const Floor& floor : floors()) {
        const MeshModel ground = makeModel(floor.mesh.view());
        for (const float tilt : {0.01F, 0.04F, -0.04F}) {
            const Matrix3f turn =
                yaw(0.3F) * Eigen::AngleAxisf(tilt, Vector3f(1, 0, 0.5F).normalized()).toRotationMatrix();
            const Pose blockInWorld{turn, Vector3f(0.1F, half.y() + 0.01F, 0.05F)};
            const ContactList contacts = localContactsOf(block, ground, inverse(blockInWorld), flatReach);
            for (int corner = 0; corner < 4; ++corner) {
                const Vector3f onA(corner % 2 == 0 ? half.x() : -half.x(), -half.y(),
                                   corner / 2 == 0 ? half.z() : -half.z());
                const float height = apply(blockInWorld, onA).y();
                const auto found = std::find_if(contacts.begin(), contacts.end(), [&](const SurfaceContact& contact) {
                    return (contact.onA - onA).norm() < 1e-5F;
                });
                ASSERT_NE(found, contacts.end()) << floor.name << ", tilt " << tilt << ", corner " << corner;
                EXPECT_NEAR(found->signedDistance, height, 1e-5F);
                EXPECT_LT((turn * found->normal - Vector3f::UnitY()).norm(), 1e-5F);
            }
        }
    }
}

// Stacked boxes, exactly aligned or shifted by anything: the corners of the rectangle in which they overlap are there,
// and nothing is slanted.
TEST(FlatContacts, StackedBoxesTouchInTheWholeOverlap) {
    const Vector3f half(0.5F, 0.5F, 0.5F);
    test::Random random(11);
    for (const int cells : {1, 2}) {
        const MeshModel box = makeModel(scenes::box(half, cells).view());
        for (const float gap : {0.04F, 0.001F, -0.001F, -0.01F}) {
            std::vector<Vector3f> offsets = {{0, 0, 0},     {1e-6F, 0, 0},   {1e-5F, 0, -1e-5F}, {1e-3F, 0, 1e-4F},
                                             {0.01F, 0, 0}, {0.3F, 0, 0.3F}, {0, 0, -0.2F}};
            for (std::size_t i = 0; i < test::sampleSize(5, 200); ++i) {
                offsets.emplace_back(static_cast<float>(random.uniform(-0.9, 0.9)), 0,
                                     static_cast<float>(random.uniform(-0.9, 0.9)));
            }
            for (const Vector3f& offset : offsets) {
                const Vector3f up(0, 2 * half.y() + gap, 0);
                const ContactList contacts = localContactsOf(box, box, {Matrix3f::Identity(), -up - offset}, flatReach);
                const std::string where = "cells " + std::to_string(cells) + ", gap " + std::to_string(gap) +
                                          ", offset " + testing::PrintToString(offset.transpose()) + ": ";
                for (const SurfaceContact& contact : contacts) {
                    // A corner beside a rim by less than a thousandth of the gap may count as above it.
                    EXPECT_GT(contact.normal.y(), 1 - 1e-5F) << where << testing::PrintToString(contact);
                    EXPECT_NEAR(contact.signedDistance, gap, 1e-4F) << where << testing::PrintToString(contact);
                }
                const Vector3f low = (-half).cwiseMax(-half - offset);
                const Vector3f high = half.cwiseMin(half - offset);
                for (int corner = 0; corner < 4; ++corner) {
                    const Vector3f onA(corner % 2 == 0 ? low.x() : high.x(), -half.y(),
                                       corner / 2 == 0 ? low.z() : high.z());
                    EXPECT_TRUE(isPresent(contacts, onA, 2e-4F)) << where << onA.transpose();
                }
            }
        }
    }
}

TEST(FlatContacts, TurnedStackedBoxesAreFlatAndComplete) {
    const Vector3f half(0.5F, 0.5F, 0.5F);
    const MeshModel box = makeModel(scenes::box(half).view());
    for (const float gap : {0.03F, 1e-3F, -1e-3F, -0.01F}) {
        for (const float angle : {1e-6F, 1e-5F, 1e-4F, 1e-3F, 0.01F, 0.03F, 0.2F, 0.785398F, 1.5F}) {
            const Pose pose{yaw(angle), Vector3f(0, -1 - gap, 0)};
            const ContactList contacts = localContactsOf(box, box, pose, flatReach);
            Vector3f low = Vector3f::Ones();
            Vector3f high = -Vector3f::Ones();
            for (const SurfaceContact& contact : contacts) {
                EXPECT_GT(contact.normal.y(), 1 - 1e-5F) << angle << testing::PrintToString(contact);
                EXPECT_NEAR(contact.signedDistance, gap, 1e-4F) << angle << testing::PrintToString(contact);
                low = low.cwiseMin(contact.onA);
                high = high.cwiseMax(contact.onA);
            }
            // The overlap of two squares turned about their middle reaches at least to the inscribed circle.
            EXPECT_LT(low.x(), -0.49F) << gap << ' ' << angle;
            EXPECT_LT(low.z(), -0.49F) << gap << ' ' << angle;
            EXPECT_GT(high.x(), 0.49F) << gap << ' ' << angle;
            EXPECT_GT(high.z(), 0.49F) << gap << ' ' << angle;
        }
    }
}

// Neighbours in a row of blocks must not feel each other's upper or lower sides.
TEST(FlatContacts, BoxesSideBySideOnlyPushSideways) {
    const MeshModel box = makeModel(scenes::box(Vector3f::Constant(0.5F), 2).view());
    for (const float gap : {0.02F, 1e-3F, 1e-5F, 0.0F, -1e-5F, -1e-3F}) {
        for (const float lower : {0.0F, 0.003F, 0.03F, 0.4F}) {
            const Pose pose{Matrix3f::Identity(), Vector3f(-1 - gap, -lower, 0)};
            const ContactList contacts = localContactsOf(box, box, pose, flatReach);
            EXPECT_GE(contacts.size(), 4U);
            for (const SurfaceContact& contact : contacts) {
                EXPECT_GT(contact.normal.x(), 0.999F)
                    << "gap " << gap << " lower " << lower << ' ' << testing::PrintToString(contact);
                EXPECT_NEAR(contact.signedDistance, gap, 2e-5F)
                    << "gap " << gap << " lower " << lower << ' ' << testing::PrintToString(contact);
            }
        }
    }
}

// A body under a thin plate is outside of it, though behind its upper face.
TEST(FlatContacts, NothingIsPulledThroughAPlate) {
    const MeshModel plate = makeModel(scenes::box({2, 0.005F, 2}, 3).view());
    const MeshModel body = makeModel(scenes::box(Vector3f::Constant(0.01F)).view());
    for (const float gap : {0.001F, 0.01F, 0.02F}) {
        const Pose plateInBody{yaw(0.4F), Vector3f(0.1F, 0.015F + gap, 0)};
        const ContactList contacts = localContactsOf(body, plate, plateInBody, flatReach);
        EXPECT_GE(contacts.size(), 4U);
        expectFlat(contacts, -Vector3f::UnitY(), gap, "under the plate: ");
    }
}

TEST(FlatContacts, ASheetPushesTowardsTheSideWhereTheBodyIs) {
    const MeshModel sheet = makeModel(scenes::grid(2, 2, 5, 5).view());
    const MeshModel body = makeModel(scenes::box(Vector3f::Constant(0.2F)).view());
    for (const float side : {1.0F, -1.0F}) {
        for (const float gap : {0.02F, -0.02F}) {
            const Pose sheetInBody{Matrix3f::Identity(), Vector3f(0.13F, -side * (0.2F + gap), 0.07F)};
            const ContactList contacts = localContactsOf(body, sheet, sheetInBody, flatReach);
            EXPECT_GE(contacts.size(), 4U);
            expectFlat(contacts, side * Vector3f::UnitY(), gap, "sheet: ");
        }
    }
    // Wholly below it, by less than the search distance: free.
    const MeshModel small = makeModel(scenes::box(Vector3f::Constant(0.01F)).view());
    const ContactList below =
        localContactsOf(small, sheet, {Matrix3f::Identity(), Vector3f(0.13F, 0.03F, 0)}, flatReach);
    expectFlat(below, -Vector3f::UnitY(), 0.02F, "below: ");
    EXPECT_GE(below.size(), 4U);
}

TEST(FlatContacts, TwoSheetsNeverPenetrate) {
    const MeshModel lower = makeModel(scenes::grid(1, 1, 4, 4).view());
    const MeshModel upper = makeModel(scenes::grid(0.5F, 0.5F, 3, 3).view());
    for (const float height : {0.03F, -0.03F}) {
        const ContactList contacts = localContactsOf(upper, lower, {yaw(0.2F), Vector3f(0, -height, 0)}, flatReach);
        EXPECT_GE(contacts.size(), 4U);
        expectFlat(contacts, Vector3f(0, height > 0 ? 1 : -1, 0), 0.03F, "sheets: ");
    }
}

// Below the line of a valley a tip is under neither face; it still must come out.
TEST(FlatContacts, ATipUnderAValleyComesOut) {
    const MeshModel tip = [] {
        scenes::Mesh mesh;  // tetrahedron standing on its corner at the origin
        mesh.vertices = {{0, 0, 0}, {0.2F, 0.6F, 0.1F}, {-0.2F, 0.6F, 0.1F}, {0, 0.6F, -0.2F}};
        mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
        return makeModel(mesh.view());
    }();
    if (!tip.solid) {
        GTEST_FAIL() << "the tip is inside out";
    }
    for (const float slope : {0.05F, 0.3F}) {
        scenes::Mesh sheet;  // V along z through the origin
        sheet.vertices = {{0, 0, -2},        {0, 0, 2},           {2, 2 * slope, -2},
                          {2, 2 * slope, 2}, {-2, 2 * slope, -2}, {-2, 2 * slope, 2}};
        sheet.triangles = {{0, 1, 3}, {0, 3, 2}, {0, 4, 5}, {0, 5, 1}};
        // The same valley as the upper side of a solid.
        scenes::Mesh block = scenes::box({2, 1, 2}, 2);
        for (Vector3f& vertex : block.vertices) {
            vertex.y() = vertex.y() > 0.5F ? slope * std::abs(vertex.x()) : vertex.y() - 1;
        }
        for (const scenes::Mesh& mesh : {sheet, block}) {
            const MeshModel valley = makeModel(mesh.view());
            for (const float depth : {0.002F, 0.02F}) {
                const ContactList contacts =
                    localContactsOf(tip, valley, {Matrix3f::Identity(), Vector3f(0, depth, 0.1F)}, flatReach);
                const SurfaceContact* contact = test::deepest(contacts);
                ASSERT_NE(contact, nullptr) << slope << ' ' << depth << ' ' << valley.solid;
                EXPECT_NEAR(contact->signedDistance, -depth, 0.05F * depth) << valley.solid;
                EXPECT_GT(contact->normal.y(), 0.95F) << valley.solid;
            }
        }
    }
}

}  // namespace
}  // namespace grapeshot
