#include <grapeshot/plugin/mass_properties.hpp>

#include <cmath>
#include <limits>

#include "bullet_fixture.hpp"

namespace grapeshot::test {
namespace {

void expectNear(const btVector3& value, const btVector3& expected, double relative) {
    const double scale = expected.length();
    EXPECT_NEAR(value.x(), expected.x(), relative * scale);
    EXPECT_NEAR(value.y(), expected.y(), relative * scale);
    EXPECT_NEAR(value.z(), expected.z(), relative * scale);
}

TEST(MassProperties, SolidBoxOfEveryKindAndScale) {
    for (const Kind kind : allKinds) {
        const MeshShape shape(scenes::moved(scenes::box({0.5F, 1.0F, 1.5F}, 2), {7, -3, 2}), kind, 0.01_s, {2, 1, 1});
        const MassProperties found = massProperties(shape.get(), 6);
        ASSERT_EQ(found.status, Status::ok);
        EXPECT_TRUE(found.solid);
        EXPECT_NEAR(found.volume, 2 * 2 * 3, 1e-4);
        EXPECT_NEAR(found.area, 2 * (4 + 6 + 6), 1e-4);
        // m/3 (b^2 + c^2) with half extents 1, 1, 1.5
        expectNear(found.inertia, {2 * 3.25_s, 2 * 3.25_s, 2 * 2.0_s}, 1e-5);
        expectNear(found.principal.getOrigin(), {14, -3, 2}, 1e-6);
        EXPECT_TRUE(found.principal.getBasis() == btMatrix3x3::getIdentity());
    }
}

TEST(MassProperties, BoxShell) {
    const double a = 0.5;
    const double b = 1.0;
    const double c = 1.5;
    scenes::Mesh open = scenes::box({0.5F, 1.0F, 1.5F});
    // Each pair of faces normal to an axis: mass share by area, rectangles at distance `off`.
    const double total = a * b + b * c + c * a;
    const auto about = [&](double h, double p, double q) {  // axis along h
        const double caps = p * q / total * (p * p + q * q) / 3;
        const double sidesP = h * q / total * (p * p + q * q / 3);
        const double sidesQ = h * p / total * (q * q + p * p / 3);
        return static_cast<btScalar>(caps + sidesP + sidesQ);
    };
    const MeshShape shape(open, Kind::bvh);
    const MassProperties found = massProperties(shape.get(), 1, MassModel::shell);
    ASSERT_EQ(found.status, Status::ok);
    EXPECT_FALSE(found.solid);
    EXPECT_EQ(found.volume, 0);
    expectNear(found.inertia, {about(a, b, c), about(b, c, a), about(c, a, b)}, 1e-5);
}

TEST(MassProperties, TorusAgreesWithTheFormula) {
    const double ring = 1.0;
    const double tube = 0.3;
    const MeshShape shape(scenes::torus(1.0F, 0.3F, 128, 64), Kind::part);
    const MassProperties found = massProperties(shape.get(), 2);
    ASSERT_EQ(found.status, Status::ok);
    const auto axial = static_cast<btScalar>(2 * (ring * ring + 0.75 * tube * tube));
    const auto across = static_cast<btScalar>(2 * (0.5 * ring * ring + 0.625 * tube * tube));
    expectNear(found.inertia, {across, axial, across}, 3e-3);
    EXPECT_NEAR(found.volume, 2 * std::acos(-1.0) * std::acos(-1.0) * ring * tube * tube, 5e-3);
}

TEST(MassProperties, OpenMeshesAreShells) {
    const MeshShape sheet(scenes::grid(1, 2, 4, 4), Kind::bvh);
    const MassProperties found = massProperties(sheet.get(), 3);
    ASSERT_EQ(found.status, Status::ok);
    EXPECT_FALSE(found.solid);
    EXPECT_NEAR(found.area, 8, 1e-5);
    expectNear(found.inertia, {4, 5, 1}, 1e-5);
    EXPECT_EQ(massProperties(sheet.get(), 3, MassModel::solid).status, Status::badArgument);
}

TEST(MassProperties, PrincipalFrameOfATurnedMovedBox) {
    const btTransform placed = at({3, -1, 0.5_s}, btQuaternion({0.3_s, 0.8_s, -0.5_s}, 0.9_s));
    scenes::Mesh mesh = scenes::box({0.5F, 1.0F, 1.5F});
    for (Eigen::Vector3f& v : mesh.vertices) {
        const btVector3 moved = placed * btVector3(v.x(), v.y(), v.z());
        v = {static_cast<float>(moved.x()), static_cast<float>(moved.y()), static_cast<float>(moved.z())};
    }
    const MassProperties found = massProperties(MeshShape(mesh).get(), 3);
    ASSERT_EQ(found.status, Status::ok);
    expectNear(found.principal.getOrigin(), placed.getOrigin(), 1e-5);
    // Sorted: largest extent, smallest inertia.
    expectNear(found.inertia, {1.25_s, 2.5_s, 3.25_s}, 1e-5);
    EXPECT_NEAR(found.principal.getBasis().determinant(), 1, 1e-5);
    const btMatrix3x3 inBox = placed.getBasis().transpose() * found.principal.getBasis();
    for (int row = 0; row < 3; ++row) {
        EXPECT_NEAR(std::abs(inBox[row].absolute()[inBox[row].absolute().maxAxis()]), 1, 1e-4);
    }
    // In its principal frame the mesh has the same inertia and nothing is left to turn.
    const btTransform inverse = found.principal.inverse();
    for (Eigen::Vector3f& v : mesh.vertices) {
        const btVector3 moved = inverse * btVector3(v.x(), v.y(), v.z());
        v = {static_cast<float>(moved.x()), static_cast<float>(moved.y()), static_cast<float>(moved.z())};
    }
    const MassProperties again = massProperties(MeshShape(mesh).get(), 3);
    expectNear(again.inertia, found.inertia, 1e-4);
    EXPECT_LT(again.principal.getOrigin().length(), 1e-5);
}

TEST(MassProperties, RefusesWhatItCannotDo) {
    const MeshShape box(scenes::box({1, 1, 1}));
    EXPECT_EQ(massProperties(nullptr, 1).status, Status::nullPointer);
    const btSphereShape sphere(1);
    EXPECT_EQ(massProperties(&sphere, 1).status, Status::unsupportedShape);
    const btGImpactCompoundShape compound;
    EXPECT_EQ(massProperties(&compound, 1).status, Status::unsupportedShape);
    for (const btScalar mass :
         {0.0_s, -1.0_s, std::numeric_limits<btScalar>::quiet_NaN(), std::numeric_limits<btScalar>::infinity()}) {
        EXPECT_EQ(massProperties(box.get(), mass).status, Status::badArgument);
    }
    scenes::Mesh bad = scenes::box({1, 1, 1});
    MeshShape spoilt(bad);
    spoilt.mesh.vertices[0].x() = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(massProperties(spoilt.get(), 1).status, Status::unusableMesh);
}

}  // namespace
}  // namespace grapeshot::test
