// A client of DART: two rings of triangles that are linked like two links of a chain, by DART's Bullet detector.
// usage: dart_meshes FOLDER [--register]: writes a mesh file into FOLDER; --register: our algorithms, by the dispatcher
// of DART's collision group. Prints how many contacts DART reports for links that cut each other, and for links that
// don't.
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <string>

#include <dart/collision/CollisionObject.hpp>
#include <dart/collision/CollisionOption.hpp>
#include <dart/collision/CollisionResult.hpp>
#include <dart/collision/bullet/BulletCollisionDetector.hpp>
#include <dart/collision/bullet/BulletCollisionGroup.hpp>
#include <dart/dynamics/BodyNode.hpp>
#include <dart/dynamics/FreeJoint.hpp>
#include <dart/dynamics/MeshShape.hpp>
#include <dart/dynamics/Skeleton.hpp>

#ifdef WITH_GRAPESHOT
#include <grapeshot/plugin.hpp>
#endif

namespace {

using dart::collision::BulletCollisionGroup;

/// A ring about the z axis.
std::string writeRing(const std::string& folder) {
    constexpr int around = 32;
    constexpr int across = 12;
    const std::string file = folder + "/ring.obj";
    std::ofstream out(file);
    for (int i = 0; i < around; ++i) {
        for (int j = 0; j < across; ++j) {
            const double u = 2 * M_PI * i / around;
            const double v = 2 * M_PI * j / across;
            const double r = 1 + 0.2 * std::cos(v);
            out << "v " << r * std::cos(u) << ' ' << r * std::sin(u) << ' ' << 0.2 * std::sin(v) << '\n';
        }
    }
    const auto at = [](int i, int j) { return 1 + (i % around) * across + j % across; };
    for (int i = 0; i < around; ++i) {
        for (int j = 0; j < across; ++j) {
            out << "f " << at(i, j) << ' ' << at(i + 1, j) << ' ' << at(i + 1, j + 1) << '\n';
            out << "f " << at(i, j) << ' ' << at(i + 1, j + 1) << ' ' << at(i, j + 1) << '\n';
        }
    }
    return file;
}

dart::dynamics::SkeletonPtr makeRing(const std::string& name, const std::string& file) {
    auto skeleton = dart::dynamics::Skeleton::create(name);
    auto* body = skeleton->createJointAndBodyNodePair<dart::dynamics::FreeJoint>().second;
    auto shape =
        std::make_shared<dart::dynamics::MeshShape>(Eigen::Vector3d::Ones(), dart::dynamics::MeshShape::loadMesh(file));
    body->createShapeNodeWith<dart::dynamics::CollisionAspect>(shape);
    return skeleton;
}

/// Reaches the dispatcher as a class derived from the group would.
struct Reach : BulletCollisionGroup {
    static btCollisionDispatcher* dispatcherOf(BulletCollisionGroup& group) {
        return static_cast<btCollisionDispatcher*>((group.*&Reach::mBulletDispatcher).get());
    }
};

std::size_t contactsOf(BulletCollisionGroup& group) {
    dart::collision::CollisionOption option;
    option.maxNumContacts = 1000;
    dart::collision::CollisionResult result;
    group.collide(option, &result);
    return result.getNumContacts();
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) {
        std::fprintf(stderr, "usage: dart_meshes FOLDER [--register]\n");
        return 2;
    }
    const std::string file = writeRing(argv[1]);
    const auto first = makeRing("first", file);
    const auto second = makeRing("second", file);
    auto detector = dart::collision::BulletCollisionDetector::create();
    auto owner = detector->createCollisionGroup(first.get(), second.get());
    auto& group = dynamic_cast<BulletCollisionGroup&>(*owner);
    if (argc > 2 && std::strcmp(argv[2], "--register") == 0) {
#ifdef WITH_GRAPESHOT
        if (grapeshot::registerAlgorithms(Reach::dispatcherOf(group)) != grapeshot::Status::ok) {
            return 1;
        }
#else
        std::fprintf(stderr, "built without Grapeshot\n");
        return 2;
#endif
    }
    auto* joint = second->getJoint(0);
    Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
    place.linear() = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitX()).toRotationMatrix();
    const auto move = [&](double x) {
        place.translation().x() = x;
        joint->setPositions(dart::dynamics::FreeJoint::convertToPositions(place));
    };
    move(1.7);  // 0.3 m apart along x, tubes of 0.2 m: they cut each other
    const std::size_t cutting = contactsOf(group);
    move(1);  // linked, the tube of one in the middle of the other
    const std::size_t linked = contactsOf(group);
    std::printf("cutting %zu linked %zu\n", cutting, linked);
    return 0;
}
