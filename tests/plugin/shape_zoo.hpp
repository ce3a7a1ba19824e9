// One of every shape that Bullet has, about half a metre in size, for tests that want all of them.
#pragma once

#include <BulletCollision/CollisionDispatch/btEmptyCollisionAlgorithm.h>
#include <BulletCollision/CollisionShapes/btBox2dShape.h>
#include <BulletCollision/CollisionShapes/btConvex2dShape.h>
#include <BulletCollision/CollisionShapes/btConvexPointCloudShape.h>
#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>
#include <BulletCollision/CollisionShapes/btMinkowskiSumShape.h>
#include <BulletCollision/CollisionShapes/btMultimaterialTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btTriangleIndexVertexMaterialArray.h>
#include <BulletCollision/CollisionShapes/btTriangleShape.h>

#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bullet_fixture.hpp"

namespace grapeshot::test {

/// Of what kind a concave shape is.
enum class Concave { mesh, part, gimpactCompound, bvh, scaledBvh, multiMaterial, heightField };
inline constexpr std::array allConcave{Concave::mesh,       Concave::part,      Concave::gimpactCompound,
                                       Concave::bvh,        Concave::scaledBvh, Concave::multiMaterial,
                                       Concave::heightField};

inline const char* nameOf(Concave kind) {
    constexpr std::array names{"mesh", "part", "gimpactCompound", "bvh", "scaledBvh", "multiMaterial", "heightField"};
    return names[static_cast<std::size_t>(kind)];
}

struct ZooShape {
    std::string name;
    btCollisionShape* shape = nullptr;
    /// Farthest point in a direction (unit), shape's frame, margins included.
    std::function<btVector3(const btVector3&)> support;
    bool solid = true;  ///< it has an inside
};

/// Owns what it makes.
class ShapeZoo {
  public:
    /// A flat floor of 6 m x 6 m whose top is at y = 0 before its margin; solid ones reach down to -1.
    ZooShape floor(Concave kind, btScalar margin) {
        switch (kind) {
            case Concave::gimpactCompound:
                return compoundOf({{6, 0.5_s, 6}}, {0, -0.5_s, 0});
            case Concave::heightField: {
                std::vector<float>& heights = m_heights.emplace_back(13 * 13, 0.0F);
                return field(13, heights, 0.5_s, margin, "floor");
            }
            default:
                return meshOf(scenes::moved(scenes::box({3, 0.5F, 3}, 7), {0, -0.5F, 0}), kind, margin);
        }
    }

    /// Something to lie on it; not convex, except that a height field has no volume.
    ZooShape body(Concave kind, btScalar margin) {
        switch (kind) {
            case Concave::gimpactCompound:
                return compoundOf({{0.5_s, 0.1_s, 0.1_s}, {0.1_s, 0.1_s, 0.4_s}, {0.1_s, 0.5_s, 0.1_s}}, {0, 0, 0});
            case Concave::heightField: {
                std::vector<float>& heights = m_heights.emplace_back();
                for (int i = 0; i < 25; ++i) {
                    heights.push_back(0.07F * static_cast<float>(i * 7 % 5 - 2));
                }
                return field(5, heights, 0.2_s, margin, "body");
            }
            default:
                return meshOf(scenes::crenelBlock({0.5F, 0.3F, 0.4F}, 3), kind, margin);
        }
    }

    /// Every convex shape of Bullet's.
    std::vector<ZooShape> convex() {
        std::vector<ZooShape> all;
        const auto add = [&](const char* name, btConvexShape* shape) {
            // As GJK sees it.
            all.push_back({name, shape, [shape](const btVector3& direction) {
                               return shape->localGetSupportVertexWithoutMarginNonVirtual(direction) +
                                      direction * shape->getMarginNonVirtual();
                           }});
        };
        const auto addPlain = [&](const char* name, btConvexShape* shape) {
            all.push_back({name, shape,
                           [shape](const btVector3& direction) { return shape->localGetSupportingVertex(direction); }});
        };
        const std::vector<btVector3>& points = m_points;
        addPlain("sphere", keep<btSphereShape>(0.3_s));
        addPlain("box", keep<btBoxShape>(btVector3(0.3_s, 0.2_s, 0.4_s)));
        addPlain("capsule", keep<btCapsuleShape>(0.2_s, 0.4_s));
        addPlain("capsuleX", keep<btCapsuleShapeX>(0.2_s, 0.4_s));
        add("cylinder", keep<btCylinderShape>(btVector3(0.3_s, 0.4_s, 0.3_s)));
        add("cylinderX", keep<btCylinderShapeX>(btVector3(0.4_s, 0.3_s, 0.3_s)));
        add("cylinderZ", keep<btCylinderShapeZ>(btVector3(0.3_s, 0.3_s, 0.4_s)));
        add("cone", keep<btConeShape>(0.3_s, 0.6_s));
        add("coneX", keep<btConeShapeX>(0.3_s, 0.6_s));
        add("coneZ", keep<btConeShapeZ>(0.3_s, 0.6_s));
        auto* hull = keep<btConvexHullShape>(&points[0][0], static_cast<int>(points.size()),
                                             static_cast<int>(sizeof(btVector3)));
        add("hull", hull);
        add("pointCloud",
            keep<btConvexPointCloudShape>(m_points.data(), static_cast<int>(points.size()), btVector3(1, 1, 1)));
        m_meshes.emplace_back(scenes::box({0.3F, 0.25F, 0.35F}), Kind::bvh);
        add("convexMesh", keep<btConvexTriangleMeshShape>(m_meshes.back().arrays.get()));
        const btVector3 centres[2] = {{-0.2_s, 0, 0}, {0.2_s, 0.1_s, 0}};
        const btScalar radii[2] = {0.2_s, 0.1_s};
        add("multiSphere", keep<btMultiSphereShape>(centres, radii, 2));
        auto* small = keep<btBoxShape>(btVector3(0.2_s, 0.1_s, 0.15_s));
        add("minkowskiSum", keep<btMinkowskiSumShape>(small, keep<btSphereShape>(0.1_s)));
        add("convex2d", keep<btConvex2dShape>(hull));
        // Thinner than its margin it would be inside out to GJK.
        add("box2d", keep<btBox2dShape>(btVector3(0.3_s, 0.2_s, 0.04_s)));
        auto* child = keep<btCylinderShape>(btVector3(0.2_s, 0.25_s, 0.2_s));
        add("uniformScaling", keep<btUniformScalingShape>(child, 1.4_s));
        add("triangle", keep<btTriangleShape>(points[0], points[1], points[2]));
        add("simplex", keep<btBU_Simplex1to4>(points[0], points[1], points[2], points[3]));
        return all;
    }

    /// The shape as the child of a compound, at a pose of its own.
    ZooShape inCompound(const ZooShape& child, const btTransform& pose) {
        auto* compound = keep<btCompoundShape>();
        compound->addChildShape(pose, child.shape);
        return {child.name + "InCompound", compound,
                [support = child.support, pose](const btVector3& direction) {
                    return pose * support(pose.getBasis().transpose() * direction);
                },
                child.solid};
    }

    template <class Shape, class... Arguments>
    Shape* keep(Arguments&&... arguments) {
        auto made = std::make_unique<Shape>(std::forward<Arguments>(arguments)...);
        Shape* shape = made.get();
        m_shapes.push_back(std::move(made));
        return shape;
    }

  private:
    ZooShape meshOf(const scenes::Mesh& mesh, Concave kind, btScalar margin) {
        const auto corners = std::make_shared<scenes::Mesh>(mesh);
        const auto support = [corners, margin](const btVector3& direction) {
            btVector3 best(0, 0, 0);
            btScalar farthest = -BT_LARGE_FLOAT;
            for (const Eigen::Vector3f& v : corners->vertices) {
                const btVector3 corner(v.x(), v.y(), v.z());
                if (corner.dot(direction) > farthest) {
                    farthest = corner.dot(direction);
                    best = corner;
                }
            }
            return best + margin * direction;
        };
        if (kind == Concave::multiMaterial) {
            m_meshes.emplace_back(mesh, Kind::bvh, margin);
            auto* arrays = m_meshes.back().arrays.get();
            m_materialArrays.push_back(std::make_unique<btTriangleIndexVertexMaterialArray>());
            m_materialArrays.back()->addIndexedMesh(arrays->getIndexedMeshArray()[0], PHY_INTEGER);
            auto* shape = keep<btMultimaterialTriangleMeshShape>(m_materialArrays.back().get(), true);
            shape->setMargin(margin);
            return {nameOf(kind), shape, support};
        }
        if (kind == Concave::scaledBvh) {
            // Half as long and scaled to its length.
            scenes::Mesh half = mesh;
            for (Eigen::Vector3f& v : half.vertices) {
                v.x() /= 2;
            }
            m_meshes.emplace_back(half, Kind::scaledBvh, margin, btVector3(2, 1, 1));
        } else {
            m_meshes.emplace_back(mesh,
                                  kind == Concave::mesh   ? Kind::mesh
                                  : kind == Concave::part ? Kind::part
                                                          : Kind::bvh,
                                  margin);
        }
        return {nameOf(kind), m_meshes.back().get(), support};
    }

    ZooShape compoundOf(const std::vector<btVector3>& halves, const btVector3& offset) {
        auto* compound = keep<btGImpactCompoundShape>();
        for (const btVector3& half : halves) {
            compound->addChildShape(at(offset), keep<btBoxShape>(half));
        }
        compound->updateBound();
        const auto support = [halves, offset](const btVector3& direction) {
            btVector3 best(0, 0, 0);
            btScalar farthest = -BT_LARGE_FLOAT;
            for (const btVector3& half : halves) {
                btVector3 corner = offset;
                for (int axis = 0; axis < 3; ++axis) {
                    corner[axis] += direction[axis] < 0 ? -half[axis] : half[axis];
                }
                if (corner.dot(direction) > farthest) {
                    farthest = corner.dot(direction);
                    best = corner;
                }
            }
            return best;
        };
        return {nameOf(Concave::gimpactCompound), compound, support};
    }

    ZooShape field(int side, const std::vector<float>& heights, btScalar spacing, btScalar margin, const char* name) {
        auto* shape = keep<btHeightfieldTerrainShape>(side, side, heights.data(), -1.0_s, 1.0_s, 1, false);
        shape->setLocalScaling({spacing, 1, spacing});
        shape->setMargin(margin);
        const auto support = [shape, side, margin](const btVector3& direction) {
            btVector3 best(0, 0, 0);
            btScalar farthest = -BT_LARGE_FLOAT;
            for (int i = 0; i < side * side; ++i) {
                btVector3 corner;
                shape->getVertex(i % side, i / side, corner);
                if (corner.dot(direction) > farthest) {
                    farthest = corner.dot(direction);
                    best = corner;
                }
            }
            return best + margin * direction;
        };
        return {std::string(nameOf(Concave::heightField)) + name, shape, support, false};
    }

    std::vector<btVector3> m_points{{0.3_s, 0.1_s, 0.2_s},   {-0.3_s, 0.2_s, 0.1_s},   {0, -0.3_s, 0.25_s},
                                    {0.1_s, 0.05_s, -0.4_s}, {-0.2_s, -0.2_s, -0.1_s}, {0.2_s, 0.3_s, -0.1_s}};
    std::deque<std::vector<float>> m_heights;
    std::deque<MeshShape> m_meshes;
    std::vector<std::unique_ptr<btTriangleIndexVertexMaterialArray>> m_materialArrays;
    std::vector<std::unique_ptr<btCollisionShape>> m_shapes;
};

}  // namespace grapeshot::test
