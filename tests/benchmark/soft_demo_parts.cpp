#include "soft_demo_parts.hpp"

#include <array>
#include <cmath>

#include <grapeshot/core/random.hpp>

namespace grapeshot::bench::demo {

double drawn(std::uint32_t index) {
    return 2 * static_cast<double>(randomUnit({11, 0}, index)) - 1;
}

btBoxShape* box(double x, double y, double z) {
    return new btBoxShape(at(x, y, z));
}

void flatGround(World& world) {
    world.add(box(100, 1.5, 100), at(0, -12, 0), 0);
}

void wavyGround(World& world) {
    scenes::Mesh mesh = scenes::grid(120, 120, 29, 29);
    for (Eigen::Vector3f& v : mesh.vertices) {
        v.y() = 1.2F * std::sin(v.x() / 8.3F) * std::cos(v.z() / 8.3F - 50);
    }
    world.addMesh(mesh, at(0, -12, 0));
}

btSoftBody* patch(World& world, double half, double height, int nodes, int fixed, const btVector3& place) {
    const auto corner = [&](double x, double z) { return place + at(x * half, height, z * half); };
    return btSoftBodyHelpers::CreatePatch(world.info(), corner(-1, -1), corner(1, -1), corner(-1, 1), corner(1, 1),
                                          nodes, nodes, fixed, true);
}

namespace {

btSoftBody* ofMesh(World& world, const scenes::Mesh& mesh) {
    std::vector<btScalar> vertices;
    for (const Eigen::Vector3f& v : mesh.vertices) {
        vertices.insert(vertices.end(), {btScalar(v.x()), btScalar(v.y()), btScalar(v.z())});
    }
    std::vector<int> corners;
    for (const Triangle& t : mesh.triangles) {
        corners.insert(corners.end(), {static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2])});
    }
    return btSoftBodyHelpers::CreateFromTriMesh(world.info(), vertices.data(), corners.data(),
                                                static_cast<int>(mesh.triangles.size()));
}

}  // namespace

btSoftBody* torus(World& world) {
    return ofMesh(world, scenes::torus(2, 0.7F, 24, 12));
}
btSoftBody* lumpyBall(World& world) {
    return ofMesh(world, scenes::bumpySphere(3, 0.6F, 5, 7));
}

void bend(btSoftBody& body, double stiffness) {
    btSoftBody::Material* material = body.appendMaterial();
    material->m_kLST = number(stiffness);
    body.generateBendingConstraints(2, material);
}

void turn(btSoftBody& body, double x, double y, double z, const btVector3& place) {
    btMatrix3x3 rotation;
    rotation.setEulerZYX(number(x), number(y), number(z));
    body.transform(btTransform(rotation, place));
}

void stack(World& world, int count) {
    auto* compound = new btCompoundShape;
    compound->addChildShape(btTransform::getIdentity(), world.keep(box(4, 1, 1)));
    compound->addChildShape(btTransform(btQuaternion(SIMD_HALF_PI, 0, 0)),
                            world.keep(new btCylinderShapeX(at(4, 1, 1))));
    const std::array<btCollisionShape*, 3> shapes{world.keep(compound), world.keep(box(1, 1, 1)),
                                                  world.keep(new btSphereShape(number(1.5)))};
    for (int i = 0; i < count; ++i) {
        world.add(shapes[static_cast<std::size_t>(i % 3)], at(0, 2 + 6 * i, 0), 10);
    }
}

void plate(World& world, double mass, double height) {
    world.add(box(5, 1, 5), at(0, height, 0.5), number(mass), 1);
}

void stair(World& world, const btVector3& origin, const btVector3& half, int count) {
    btCollisionShape* step = world.keep(new btBoxShape(half));
    for (int i = 0; i < count; ++i) {
        world.add(step, origin + btVector3(2 * half.x() * btScalar(i), 2 * half.y() * btScalar(i), 0), 0, 1);
    }
}

btSoftBody* ball(World& world, const btVector3& place) {
    return btSoftBodyHelpers::CreateEllipsoid(world.info(), place, at(3, 3, 3), 512);
}

btSoftBody& keepingVolume(World& world, const btVector3& place) {
    btSoftBody* body = ball(world, place);
    body->m_materials[0]->m_kLST = number(0.45);
    body->m_cfg.kVC = 20;
    body->setTotalMass(50, true);
    body->setPose(true, false);
    return world.add(body);
}

btSoftBody* block(World& world, const btVector3& middle, double half, int cells) {
    std::vector<btVector3> nodes;
    const int side = cells + 1;
    for (int i = 0; i < side * side * side; ++i) {
        const auto along = [&](int k) { return half * (2.0 * k / cells - 1); };
        nodes.push_back(middle + at(along(i % side), along(i / side % side), along(i / side / side)));
    }
    auto* body = new btSoftBody(&world.info(), static_cast<int>(nodes.size()), nodes.data(), nullptr);
    constexpr std::array<std::array<int, 4>, 6> six{
        {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}}};
    for (int z = 0; z < cells; ++z) {
        for (int y = 0; y < cells; ++y) {
            for (int x = 0; x < cells; ++x) {
                for (const auto& t : six) {
                    std::array<int, 4> n{};
                    for (std::size_t k = 0; k < 4; ++k) {
                        n[k] = (x + t[k] % 2) + side * ((y + t[k] / 2 % 2) + side * (z + t[k] / 4));
                    }
                    body->appendTetra(n[0], n[1], n[2], n[3]);
                    for (std::size_t p = 0; p < 4; ++p) {
                        for (std::size_t q = p + 1; q < 4; ++q) {
                            body->appendLink(n[p], n[q], nullptr, true);
                        }
                    }
                }
            }
        }
    }
    return body;
}

}  // namespace grapeshot::bench::demo
