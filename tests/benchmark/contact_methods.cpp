#include "contact_methods.hpp"

#include <Eigen/Geometry>
#include <memory>

#include "decimation.hpp"

namespace grapeshot::bench {

namespace {

struct Finder {
    explicit Finder(std::shared_ptr<const Tree> of) : tree(std::move(of)), query(*tree, *tree) {}
    std::shared_ptr<const Tree> tree;
    CrossingQuery query;
    Crossing crossing;
};

ContactMethod methodOf(std::string name, const std::shared_ptr<Finder>& finder, std::uint64_t budget) {
    ContactMethod method;
    method.name = std::move(name);
    method.budget = budget;
    method.find = [finder, budget](const Pose& pose, Regions& regions) {
        finder->query.find(pose, {}, Budget{.work = budget}, finder->crossing);
        groupCrossing(finder->crossing.pieces, finder->crossing.work, contactRegions, defaultCalibration(), regions);
    };
    method.work = [finder] { return finder->crossing.work; };
    return method;
}

}  // namespace

ContactMethod estimateMethod(const Tree& tree, std::uint64_t budget) {
    return methodOf(budget == unlimited ? "exact" : "estimate " + std::to_string(budget),
                    std::make_shared<Finder>(std::shared_ptr<const Tree>(std::shared_ptr<void>(), &tree)), budget);
}

ContactMethod decimatedMethod(MeshView mesh, std::size_t triangles) {
    ContactMethod method = methodOf(
        "decimated " + std::to_string(triangles),
        std::make_shared<Finder>(std::make_shared<const Tree>(build(decimated(mesh, triangles).view()))), unlimited);
    method.triangles = triangles;
    return method;
}

ContactMethod stoppedMethod(const Tree& tree, std::uint64_t budget) {
    struct Stopped {
        explicit Stopped(const Tree& of) : query(of, of) {}
        Query query;
        Contacts contacts;
        std::vector<CurvePiece> pieces;
    };
    const auto stopped = std::make_shared<Stopped>(tree);
    ContactMethod method;
    method.name = "exact stopped " + std::to_string(budget);
    method.budget = budget;
    const auto normalOf = [&tree](std::uint32_t triangle) {
        const Triangle& corner = tree.triangles[triangle];
        const Eigen::Vector3f origin = tree.vertices[corner[0]];
        return Eigen::Vector3f(
            (tree.vertices[corner[1]] - origin).cross(tree.vertices[corner[2]] - origin).stableNormalized());
    };
    method.find = [stopped, budget, normalOf](const Pose& pose, Regions& regions) {
        stopped->query.contacts(pose, {}, Budget{.work = budget}, stopped->contacts);
        stopped->pieces.clear();
        for (const TriangleContact& contact : stopped->contacts.pairs) {
            CurvePiece& piece = stopped->pieces.emplace_back();
            piece.position = contact.onA;
            piece.direction = pose.rotation * normalOf(contact.pair.triangleB) - normalOf(contact.pair.triangleA);
            piece.pair = contact.pair;
            piece.length = 1e-3F;  // all alike
        }
        groupCrossing(stopped->pieces, stopped->contacts.work, contactRegions, defaultCalibration(), regions);
    };
    method.work = [stopped] { return stopped->contacts.work; };
    return method;
}

Contender contender(const ContactMethod& method, std::span<const Pose> poses) {
    return [find = method.find, poses](std::size_t begin, std::size_t end) {
        thread_local Regions regions;
        std::size_t found = 0;
        for (const Pose& pose : poses.subspan(begin, end - begin)) {
            find(pose, regions);
            found += regions.size();
        }
        return found;
    };
}

}  // namespace grapeshot::bench
