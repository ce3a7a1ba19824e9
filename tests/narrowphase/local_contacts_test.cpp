#include <grapeshot/narrowphase/local_contacts.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <grapeshot/adb/point_query.hpp>
#include <grapeshot/adb/query.hpp>
#include <scenes/shapes.hpp>
#include <scenes/true_penetration.hpp>
#include <support/oracle.hpp>
#include <support/poses.hpp>
#include <support/test_size.hpp>

#include "triangle_pairs.hpp"

namespace grapeshot {
namespace {

using Eigen::Matrix3f;
using Eigen::Vector3d;
using Eigen::Vector3f;
using test::localContactsOf;
using ContactList = std::vector<SurfaceContact>;

struct Named {
    const char* name;
    scenes::Mesh mesh;
};

std::vector<Named> convexMeshes() {
    return {{"cube", scenes::box({0.5F, 0.4F, 0.6F}, 2)},
            {"sphere", scenes::sphere(0.5F, 5)},
            {"coarse sphere", scenes::sphere(0.5F, 1)},
            {"rod", scenes::box({0.1F, 0.7F, 0.15F}, 1)}};
}

std::vector<Named> solids() {
    return {{"torus", scenes::torus(0.5F, 0.2F, 14, 8)},
            {"cup", scenes::cup(0.5F, 0.1F, 0.8F, 12, 2)},
            {"bumpy", scenes::bumpySphere(0.5F, 0.3F, 5, 4)},
            {"comb", scenes::comb(4, 0.4F, 0.25F, 0.12F)},
            {"cube", scenes::box({0.4F, 0.5F, 0.3F}, 2)}};
}

/// B at a random attitude, moved in along a direction to the first touch, then by `gap` (negative: into A).
Pose posed(const MeshModel& a, const MeshModel& b, double gap, test::Random& random) {
    Pose pose{random.rotation(), Vector3f::Zero()};
    const Vector3f direction = random.direction();
    Query query(a.tree, b.tree);
    const auto clear = [&](float t) {
        pose.translation = t * direction;
        return !query.decide(pose, DecideSettings::exact()).collides;
    };
    float far = a.tree.radius + b.tree.radius;
    const float step = far / 100;
    while (far > step && clear(far - step)) {
        far -= step;
    }
    float near = far - step;
    for (int i = 0; i < 16; ++i) {
        const float middle = (near + far) / 2;
        (clear(middle) ? far : near) = middle;
    }
    pose.translation = (far + static_cast<float>(gap)) * direction;
    return pose;
}

Eigen::AlignedBox3d boxOf(const test::Corners& corners) {
    Eigen::AlignedBox3d box;
    for (const Vector3d& corner : corners) {
        box.extend(corner);
    }
    return box;
}

/// The oracle's, without pairs that boxes rule out; `limit` if it is larger.
double trueDistance(const MeshModel& a, const MeshModel& b, const Pose& pose, double limit) {
    double least = limit;
    for (std::uint32_t ta = 0; ta < a.tree.triangles.size(); ++ta) {
        const test::Corners cornersA = test::cornersOf(a.tree.mesh(), ta);
        for (std::uint32_t tb = 0; tb < b.tree.triangles.size(); ++tb) {
            const test::Corners cornersB = test::cornersOf(b.tree.mesh(), tb, pose);
            if (boxOf(cornersA).exteriorDistance(boxOf(cornersB)) < least) {
                least = std::min(least, test::triangleDistance(cornersA, cornersB));
            }
        }
    }
    return least;
}

void expectConsistent(const MeshModel& a, const MeshModel& b, const Pose& pose, const ContactList& contacts,
                      float maxDistance, const std::string& where) {
    for (const SurfaceContact& contact : contacts) {
        const std::string what = where + testing::PrintToString(contact);
        EXPECT_NEAR(contact.normal.norm(), 1, 1e-5F) << what;
        EXPECT_LE(contact.signedDistance, maxDistance) << what;
        EXPECT_LT((contact.onB + contact.signedDistance * contact.normal - contact.onA).norm(), 1e-5F) << what;
        // The points lie on the triangles named (a corner may be a little beside a face, see the implementation).
        const float slack = 2e-5F + 2e-3F * std::abs(contact.signedDistance);
        ASSERT_LT(contact.triangleA, a.tree.triangles.size()) << what;
        ASSERT_LT(contact.triangleB, b.tree.triangles.size()) << what;
        const auto distanceTo = [](const MeshModel& model, std::uint32_t triangle, const Vector3f& point) {
            scenes::Mesh one;
            for (const std::uint32_t v : model.tree.triangles[triangle]) {
                one.vertices.push_back(model.tree.vertices[v]);
            }
            one.triangles.push_back({0, 1, 2});
            return closestPoint(build(one.view()), point, 10)->distance;
        };
        EXPECT_LT(distanceTo(a, contact.triangleA, contact.onA), slack) << what;
        EXPECT_LT(distanceTo(b, contact.triangleB, apply(inverse(pose), contact.onB)), slack) << what;
    }
}

// Separated: the smallest distance of all is a local extremum, so it must be among the contacts, with its direction.
TEST(LocalContacts, TheClosestPointsAreAContact) {
    test::Random random(1);
    std::vector<Named> meshes = convexMeshes();
    for (Named& solid : solids()) {
        meshes.push_back(std::move(solid));
    }
    std::vector<MeshModel> models;
    for (const Named& named : meshes) {
        models.push_back(makeModel(named.mesh.view()));
        ASSERT_TRUE(models.back().solid) << named.name;
    }
    int compared = 0;
    for (std::size_t i = 0; i < test::sampleSize(120, 3000); ++i) {
        const std::size_t ia = random.bits() % models.size();
        const std::size_t ib = random.bits() % models.size();
        const MeshModel& a = models[ia];
        const MeshModel& b = models[ib];
        const double gap = std::pow(10.0, random.uniform(-3.5, -1.3));
        const Pose pose = posed(a, b, gap, random);
        const std::string where = std::string(meshes[ia].name) + " - " + meshes[ib].name + ", sample " +
                                  std::to_string(i) + ", gap " + std::to_string(gap) + ": ";
        const ContactList contacts = localContactsOf(a, b, pose, 0.06F);
        expectConsistent(a, b, pose, contacts, 0.06F, where);
        const double truth = trueDistance(a, b, pose, 0.06);
        if (truth > 0.059 || truth < 1e-5) {
            continue;
        }
        ++compared;
        const SurfaceContact* contact = test::deepest(contacts);
        ASSERT_NE(contact, nullptr) << where << "true distance " << truth;
        EXPECT_NEAR(contact->signedDistance, truth, 2e-6 + 1e-3 * truth) << where;
    }
    EXPECT_GT(compared, 80);
}

/// Least translation that parts two convex bodies, by all face normals and edge directions (Gottschalk 1996).
struct Separation {
    double depth = 1e9;
    Vector3d axis;  // from B to A
};
Separation convexSeparation(const MeshModel& a, const MeshModel& b, const Pose& pose) {
    std::vector<Vector3d> axes;
    std::vector<Vector3d> edgesA;
    std::vector<Vector3d> edgesB;
    const Eigen::Matrix3d rotation = pose.rotation.cast<double>();
    const auto collect = [&](const MeshModel& model, const Eigen::Matrix3d& turn, std::vector<Vector3d>& edges) {
        for (const Triangle& corner : model.tree.triangles) {
            Vector3d p[3];
            for (unsigned c = 0; c < 3; ++c) {
                p[c] = turn * model.tree.vertices[corner[c]].cast<double>();
            }
            axes.push_back((p[1] - p[0]).cross(p[2] - p[0]));
            for (unsigned c = 0; c < 3; ++c) {
                const Vector3d edge = (p[(c + 1) % 3] - p[c]).normalized();
                if (std::none_of(edges.begin(), edges.end(),
                                 [&](const Vector3d& known) { return known.cross(edge).norm() < 1e-5; })) {
                    edges.push_back(edge);
                }
            }
        }
    };
    collect(a, Eigen::Matrix3d::Identity(), edgesA);
    collect(b, rotation, edgesB);
    for (const Vector3d& u : edgesA) {
        for (const Vector3d& v : edgesB) {
            axes.push_back(u.cross(v));
        }
    }
    Separation least;
    for (Vector3d axis : axes) {
        if (axis.norm() < 1e-6) {
            continue;
        }
        axis.normalize();
        double lowA = 1e9;
        double highA = -1e9;
        double lowB = 1e9;
        double highB = -1e9;
        for (const Vector3f& v : a.tree.vertices) {
            lowA = std::min(lowA, axis.dot(v.cast<double>()));
            highA = std::max(highA, axis.dot(v.cast<double>()));
        }
        for (const Vector3f& v : b.tree.vertices) {
            const double h = axis.dot(rotation * v.cast<double>() + pose.translation.cast<double>());
            lowB = std::min(lowB, h);
            highB = std::max(highB, h);
        }
        if (highB - lowA < least.depth) {
            least = {highB - lowA, axis};
        }
        if (highA - lowB < least.depth) {
            least = {highA - lowB, -axis};
        }
    }
    return least;
}

// Penetrating convex bodies: the least translation that parts them is a contact.
TEST(LocalContacts, TheLeastSeparationOfConvexBodiesIsAContact) {
    test::Random random(2);
    const std::vector<Named> meshes = {{"cube", scenes::box({0.5F, 0.4F, 0.6F})},
                                       {"fine cube", scenes::box({0.5F, 0.4F, 0.6F}, 3)},
                                       {"icosahedron", scenes::sphere(0.5F, 1)},
                                       {"rod", scenes::box({0.1F, 0.7F, 0.15F})}};
    std::vector<MeshModel> models;
    for (const Named& named : meshes) {
        models.push_back(makeModel(named.mesh.view()));
    }
    int shallow = 0;
    int found = 0;
    for (std::size_t i = 0; i < test::sampleSize(200, 5000); ++i) {
        const std::size_t ia = random.bits() % models.size();
        const std::size_t ib = random.bits() % models.size();
        const Pose pose = posed(models[ia], models[ib], -std::pow(10.0, random.uniform(-3.5, -1.5)), random);
        const std::string where =
            std::string(meshes[ia].name) + " - " + meshes[ib].name + ", sample " + std::to_string(i) + ": ";
        const Separation truth = convexSeparation(models[ia], models[ib], pose);
        const ContactList contacts = localContactsOf(models[ia], models[ib], pose, 0.06F);
        expectConsistent(models[ia], models[ib], pose, contacts, 0.06F, where);
        ++shallow;
        found += std::any_of(contacts.begin(), contacts.end(),
                             [&](const SurfaceContact& contact) {
                                 return std::abs(contact.signedDistance + truth.depth) < 1e-5 + 0.02 * truth.depth &&
                                        contact.normal.cast<double>().dot(truth.axis) > 0.99;
                             })
                     ? 1
                     : 0;
        // Nothing claims to be deeper in a direction in which the bodies part sooner.
        for (const SurfaceContact& contact : contacts) {
            double lowA = 1e9;
            double highB = -1e9;
            for (const Vector3f& v : models[ia].tree.vertices) {
                lowA = std::min<double>(lowA, contact.normal.dot(v));
            }
            for (const Vector3f& v : models[ib].tree.vertices) {
                highB = std::max<double>(highB, contact.normal.dot(apply(pose, v)));
            }
            EXPECT_GE(contact.signedDistance, lowA - highB - 1e-4) << where << testing::PrintToString(contact);
        }
    }
    EXPECT_GE(found, shallow * 98 / 100) << "of " << shallow;
}

// A penetration is real: the corner that it names is inside the other body, or the crossing edges are.
TEST(LocalContacts, PenetrationsAreInside) {
    test::Random random(5);
    const std::vector<Named> meshes = solids();
    std::vector<MeshModel> models;
    std::vector<scenes::TrueSurface> truths;
    for (const Named& named : meshes) {
        models.push_back(makeModel(named.mesh.view()));
        truths.emplace_back(named.mesh.view());
    }
    int penetrations = 0;
    int deepPoses = 0;
    int covered = 0;
    for (std::size_t i = 0; i < test::sampleSize(150, 3000); ++i) {
        const std::size_t ia = random.bits() % models.size();
        const std::size_t ib = random.bits() % models.size();
        const Pose pose = posed(models[ia], models[ib], random.uniform(-0.05, 0.0), random);
        const std::string where =
            std::string(meshes[ia].name) + " - " + meshes[ib].name + ", sample " + std::to_string(i) + ": ";
        const ContactList contacts = localContactsOf(models[ia], models[ib], pose, 0.06F);
        expectConsistent(models[ia], models[ib], pose, contacts, 0.06F, where);
        const Pose aInB = inverse(pose);
        for (const SurfaceContact& contact : contacts) {
            if (contact.signedDistance > -1e-4F) {
                continue;
            }
            ++penetrations;
            const double aInsideB = truths[ib].signedDistance(apply(aInB, contact.onA).cast<double>());
            const double bInsideA = truths[ia].signedDistance(contact.onB.cast<double>());
            // Corners are asked a quarter of the depth further inside: they often lie on the side faces.
            const double tolerated = 1e-5 + 0.25 * static_cast<double>(-contact.signedDistance);
            EXPECT_LT(std::min(aInsideB, bInsideA), tolerated) << where << testing::PrintToString(contact);
        }
        const scenes::PoseD poseA;
        const scenes::PoseD poseB{pose.rotation.cast<double>(), pose.translation.cast<double>()};
        const double depth = scenes::truePenetration(truths[ia], poseA, truths[ib], poseB);
        if (depth > 1e-3) {
            ++deepPoses;
            const SurfaceContact* contact = test::deepest(contacts);
            covered += contact != nullptr && contact->signedDistance < -0.5 * depth ? 1 : 0;
        }
    }
    EXPECT_GT(penetrations, 100);
    EXPECT_GT(deepPoses, 40);
    // What is left over is the cut's task (penetration.hpp).
    EXPECT_GE(covered, deepPoses * 9 / 10) << "of " << deepPoses;
}

TEST(LocalContacts, ExchangingTheBodiesMirrorsTheContacts) {
    test::Random random(8);
    const std::vector<Named> meshes = solids();
    int contactsSeen = 0;
    for (std::size_t i = 0; i < test::sampleSize(150, 1000); ++i) {
        const MeshModel a = makeModel(meshes[random.bits() % meshes.size()].mesh.view());
        const MeshModel b = makeModel(meshes[random.bits() % meshes.size()].mesh.view());
        const Pose pose = posed(a, b, random.uniform(-0.04, 0.03), random);
        const ContactList forth = localContactsOf(a, b, pose, 0.05F);
        const ContactList back = localContactsOf(b, a, inverse(pose), 0.05F);
        // Borderline ones may go either way; nearly all must have their mirror image.
        std::size_t matched = 0;
        for (const SurfaceContact& contact : forth) {
            const SurfaceContact image = test::mirrored(contact, pose);
            matched += std::any_of(back.begin(), back.end(),
                                   [&](const SurfaceContact& other) { return test::near(image, other, 1e-4F); })
                           ? 1
                           : 0;
        }
        contactsSeen += static_cast<int>(forth.size());
        EXPECT_GE(matched + forth.size() / 20, forth.size())
            << i << testing::PrintToString(forth) << "\n and mirrored back:\n"
            << testing::PrintToString(back);
        EXPECT_GE(forth.size() + forth.size() / 20, back.size()) << i;
        EXPECT_GE(back.size() + back.size() / 20, forth.size()) << i;
    }
    EXPECT_GT(contactsSeen, 200);
}

// Moving B's frame within B changes nothing.
TEST(LocalContacts, TheFrameDoesNotMatter) {
    test::Random random(9);
    for (const Named& named : solids()) {
        const MeshModel a = makeModel(scenes::cup(0.5F, 0.1F, 0.8F, 12, 2).view());
        const MeshModel b = makeModel(named.mesh.view());
        for (std::size_t i = 0; i < test::sampleSize(8, 200); ++i) {
            const Pose pose = posed(a, b, random.uniform(-0.03, 0.03), random);
            const Pose frame{random.rotation(), 0.3F * random.direction()};
            scenes::Mesh moved = named.mesh;
            for (Vector3f& vertex : moved.vertices) {
                vertex = apply(frame, vertex);
            }
            const ContactList before = localContactsOf(a, b, pose, 0.05F);
            const ContactList after = localContactsOf(a, makeModel(moved.view()), compose(pose, inverse(frame)), 0.05F);
            std::size_t matched = 0;
            for (const SurfaceContact& contact : before) {
                matched += std::any_of(after.begin(), after.end(),
                                       [&](const SurfaceContact& other) { return test::near(contact, other, 1e-4F); })
                               ? 1
                               : 0;
            }
            EXPECT_GE(matched + before.size() / 20, before.size()) << named.name << ' ' << i;
        }
    }
}

/// What one list has and the other does not.
std::string differences(const ContactList& found, const ContactList& expected) {
    std::string text;
    const auto missing = [&](const ContactList& from, const ContactList& in, const char* what) {
        for (const SurfaceContact& contact : from) {
            if (std::none_of(in.begin(), in.end(),
                             [&](const auto& c) { return std::memcmp(&c, &contact, sizeof c) == 0; })) {
                text += what + testing::PrintToString(contact) + "\n";
            }
        }
    };
    missing(expected, found, "left out: ");
    missing(found, expected, "too many: ");
    return text;
}

bool sameBytes(const ContactList& first, const ContactList& second) {
    return std::equal(first.begin(), first.end(), second.begin(), second.end(),
                      [](const auto& l, const auto& r) { return std::memcmp(&l, &r, sizeof l) == 0; });
}

TEST(LocalContacts, TheOrderOfThePairsDoesNotMatter) {
    test::Random random(10);
    const MeshModel a = makeModel(scenes::cup(0.5F, 0.1F, 0.8F, 12, 2).view());
    const MeshModel b = makeModel(scenes::torus(0.5F, 0.2F, 14, 8).view());
    std::size_t contactsSeen = 0;
    std::size_t overlapsSeen = 0;
    LocalContactSearch search;
    for (int i = 0; i < 60; ++i) {
        const Pose pose = posed(a, b, random.uniform(-0.04, 0.02), random);
        LeafPairs leaves;
        Query(a.tree, b.tree).leafPairs(pose, {0.06F, Order::depthFirst}, {}, leaves);
        ContactList first;
        search.start(a, b, pose, {0.08F, 0.06F});
        search.add(leaves.pairs);
        search.finish(first);
        const std::vector<TriangleContact> cuts(search.overlapping().begin(), search.overlapping().end());
        contactsSeen += first.size();
        overlapsSeen += cuts.size();
        for (std::size_t j = leaves.pairs.size(); j > 1; --j) {
            std::swap(leaves.pairs[j - 1], leaves.pairs[random.bits() % j]);
        }
        ContactList second;
        search.start(a, b, pose, {0.08F, 0.06F});
        const std::size_t half = leaves.pairs.size() / 2;
        EXPECT_EQ(search.add(std::span(leaves.pairs).first(half)), half);
        search.add(std::span(leaves.pairs).subspan(half));
        search.finish(second);
        EXPECT_TRUE(sameBytes(first, second)) << i;
        EXPECT_TRUE(std::equal(cuts.begin(), cuts.end(), search.overlapping().begin(), search.overlapping().end(),
                               [](const auto& l, const auto& r) { return l.pair == r.pair; }));
    }
    EXPECT_GT(contactsSeen, 50U);
    EXPECT_GT(overlapsSeen, 50U);
}

TEST(LocalContacts, TheFilterLeavesNothingOut) {
    std::vector<Named> meshes = solids();
    meshes.push_back({"gear", scenes::gear(0.5F, 0.08F, 0.15F, 0.25F, 9, 2)});
    meshes.push_back({"knot", scenes::torusKnot(2, 3, 0.5F, 0.2F, 0.11F, 60, 8)});
    meshes.push_back({"spiked", scenes::spikedBall(0.35F, 0.17F, 12, 600)});
    meshes.push_back({"sheet", scenes::grid(0.7F, 0.7F, 6, 6)});
    test::Random random(77);
    std::size_t contactsSeen = 0;
    std::size_t deepSeen = 0;
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        for (std::size_t j = i; j < meshes.size(); ++j) {
            const MeshModel a = makeModel(meshes[i].mesh.view());
            const MeshModel b = makeModel(meshes[j].mesh.view());
            for (std::size_t k = 0; k < test::sampleSize(6, 60); ++k) {
                const Pose pose = posed(a, b, random.uniform(-0.05, 0.04), random);
                const float lean = k % 3 == 0 ? 0.0F : (k % 3 == 1 ? 0.08F : 0.3F);
                const ContactList found = localContactsOf(a, b, pose, 0.06F, lean);
                EXPECT_EQ(differences(found, test::exhaustiveContactsOf(a, b, pose, 0.06F, lean)), "")
                    << meshes[i].name << ' ' << meshes[j].name << ' ' << k;
                contactsSeen += found.size();
                deepSeen +=
                    std::count_if(found.begin(), found.end(), [](const auto& c) { return c.signedDistance < 0; });
            }
        }
    }
    EXPECT_GT(contactsSeen, 500U);
    EXPECT_GT(deepSeen, 100U);
}

/// Of finely tessellated bodies most leaves that are within reach lie beside each other.
TEST(LocalContacts, LeavesBesideEachOtherCostNothing) {
    const MeshModel a = makeModel(scenes::bumpySphere(1.0F, 0.25F, 7, 32, 77).view());
    test::Random random(3);
    LocalContactSearch search;
    std::size_t near = 0;
    std::size_t tested = 0;
    for (int i = 0; i < 20; ++i) {
        const Pose pose = posed(a, a, random.uniform(0.03, 0.045), random);
        LeafPairs leaves;
        Query(a.tree, a.tree).leafPairs(pose, {0.06F, Order::depthFirst}, {}, leaves);
        search.start(a, a, pose, {0.08F, 0.06F});
        const std::span<const LeafPair> pairs(leaves.pairs);
        for (std::size_t first = 0; first < pairs.size(); first += LocalContactSearch::fewPairs) {
            const auto few = pairs.subspan(first, std::min(LocalContactSearch::fewPairs, pairs.size() - first));
            std::uint32_t within = 0;
            EXPECT_EQ(search.addFew(few, unlimited, within), few.size());
            near += static_cast<std::size_t>(std::popcount(within));
        }
        tested += search.tested();
        ContactList contacts;
        search.finish(contacts);
        EXPECT_FALSE(contacts.empty());
    }
    EXPECT_GT(tested, 0U);
    EXPECT_LT(tested * 2, near);
}

TEST(LocalContacts, FlatPartsInAnyPoseAreFilteredLikeOthers) {
    // Faces on faces, edges along edges, corners on corners: where the filter's tolerances matter.
    const MeshModel a = makeModel(scenes::box({0.5F, 0.4F, 0.6F}, 3).view());
    const MeshModel b = makeModel(scenes::comb(4, 0.4F, 0.25F, 0.12F).view());
    test::Random random(5);
    std::size_t contactsSeen = 0;
    for (std::size_t k = 0; k < test::sampleSize(150, 1500); ++k) {
        Pose pose{Matrix3f::Identity(), Vector3f::Zero()};
        const auto axis = static_cast<int>(k % 3);
        const float turn = static_cast<float>(k / 3 % 4) * 1.5707963F + (k % 2 == 0 ? 0.0F : 0.01F);
        pose.rotation = Eigen::AngleAxisf(turn, Vector3f::Unit((axis + 1) % 3)).toRotationMatrix();
        for (int i = 0; i < 3; ++i) {
            pose.translation[i] = static_cast<float>(random.uniform(-0.5, 0.5));
        }
        pose.translation[axis] =
            (random.bits() % 2 == 0 ? 1.0F : -1.0F) *
            (a.tree.upper[axis] + b.tree.upper[axis] + static_cast<float>(random.uniform(-0.02, 0.04)));
        const ContactList found = localContactsOf(a, b, pose, 0.05F);
        EXPECT_EQ(differences(found, test::exhaustiveContactsOf(a, b, pose, 0.05F)), "") << k;
        contactsSeen += found.size();
    }
    EXPECT_GT(contactsSeen, 300U);
}

TEST(LocalContacts, WorkIsKept) {
    const MeshModel a = makeModel(scenes::bumpySphere(0.5F, 0.3F, 5, 8).view());
    const Pose pose{Matrix3f::Identity(), Vector3f(0.8F, 0.1F, 0)};
    LeafPairs leaves;
    Query(a.tree, a.tree).leafPairs(pose, {0.05F, Order::depthFirst}, {}, leaves);
    LocalContactSearch search;
    search.start(a, a, pose, {0.08F, 0.05F});
    search.add(leaves.pairs);
    const std::uint64_t whole = search.work();
    ASSERT_GT(whole, 20U);
    const std::uint64_t enough = whole + 2;  // the last pair may cost three, until it is known that it costs less
    for (const std::uint64_t most : {std::uint64_t{0}, std::uint64_t{3}, std::uint64_t{10}, enough}) {
        search.start(a, a, pose, {0.08F, 0.05F});
        const std::size_t done = search.add(leaves.pairs, most);
        EXPECT_LE(search.work(), most);
        EXPECT_EQ(done == leaves.pairs.size(), most == enough);
    }
}

TEST(LocalContacts, AppendsAndFarBodiesGiveNothing) {
    const MeshModel a = makeModel(scenes::sphere(0.5F, 3).view());
    ContactList out(3);
    LocalContactSearch search;
    search.start(a, a, {Matrix3f::Identity(), Vector3f(5, 0, 0)}, {});
    search.finish(out);
    EXPECT_EQ(out.size(), 3U);
    const ContactList near = localContactsOf(a, a, {Matrix3f::Identity(), Vector3f(1.01F, 0, 0)}, 0.05F);
    EXPECT_FALSE(near.empty());
    EXPECT_NE(near[0].triangleA, noTriangle);
}

// A ball in a bowl that it fits: contacts all around, each along the radius.
TEST(LocalContacts, ABallInACupOfNearlyItsSize) {
    const MeshModel cup = makeModel(scenes::cup(0.5F, 0.1F, 0.8F, 24, 4).view());
    const MeshModel ball = makeModel(scenes::sphere(0.38F, 6).view());
    const float floor = cup.tree.lower.y() + 0.1F;
    const Pose pose{Matrix3f::Identity(), Vector3f(0, floor + 0.38F + 0.005F, 0)};
    const ContactList contacts = localContactsOf(cup, ball, pose, 0.06F);
    bool below = false;
    for (const SurfaceContact& contact : contacts) {
        EXPECT_GT(contact.signedDistance, 0) << testing::PrintToString(contact);
        const Vector3f radial = (contact.onB - pose.translation).normalized();
        EXPECT_GT(contact.normal.dot(radial), 0.97F) << testing::PrintToString(contact);
        below = below || contact.normal.y() < -0.99F;
    }
    EXPECT_TRUE(below);
}

}  // namespace
}  // namespace grapeshot
