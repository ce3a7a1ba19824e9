#include "meshes.hpp"

#include <support/poses.hpp>

namespace grapeshot::test {

const std::vector<NamedMesh>& everyKind() {
    static const std::vector<NamedMesh> meshes = [] {
        using namespace scenes;
        std::vector<NamedMesh> all = {
            {"box", box({1, 0.7F, 0.4F}, 3)},
            {"sphere", sphere(1, 4)},
            {"torus", torus(1, 0.3F, 20, 8)},
            {"cup", cup(1, 0.2F, 1.5F, 16, 4)},
            {"spiked ball", spikedBall(1, 0.8F, 12, 300)},
            {"chain shot", chainShot(1, 0.2F, 16, 6)},
            {"ring", ring(1, 0.2F, 20, 8)},
            {"crenel block", crenelBlock({1, 0.5F, 0.4F}, 4)},
            {"arch block", archBlock({1, 0.8F, 0.4F}, 0.5F, 10)},
            {"u", uBody(1, 0.8F, 0.2F, 0.4F)},
            {"cross", crossPlug(1, 0.3F, 1, 2)},
            {"plate", plateWithCrossHole(1, 0.2F, 0.5F, 0.2F, 0.02F)},
            {"bumpy sphere", bumpySphere(1, 0.25F, 6, 4)},
            {"torus knot", torusKnot(2, 3, 1, 0.5F, 0.2F, 40, 6)},
            {"gear", gear(1, 0.2F, 0.3F, 0.3F, 10)},
            {"comb", comb(6, 1, 0.4F, 0.2F)},
            {"grid", grid(1, 1, 10, 10)},
            {"soup", soup(200, 0.4F, 5)},
        };
        for (NamedMesh& mesh : all) {
            mesh.mesh = normalised(std::move(mesh.mesh));
        }
        return all;
    }();
    return meshes;
}

scenes::Mesh soup(int triangles, float extent, std::uint64_t seed) {
    scenes::Mesh mesh;
    Random random(seed);
    const auto inCube = [&random] {
        return Eigen::Vector3d(random.unit(), random.unit(), random.unit()).cast<float>().eval();
    };
    for (int i = 0; i < triangles; ++i) {
        const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
        const Eigen::Vector3f place = inCube();
        for (int corner = 0; corner < 3; ++corner) {
            mesh.vertices.emplace_back(place + extent * (inCube() - Eigen::Vector3f::Constant(0.5F)));
        }
        mesh.triangles.push_back({first, first + 1, first + 2});
    }
    return mesh;
}

scenes::Mesh needles(int count) {
    scenes::Mesh mesh;
    Random random(11);
    for (int i = 0; i < count; ++i) {
        const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
        const Eigen::Vector3f root = 0.3F * random.direction();
        const Eigen::Vector3f tip = root + random.direction();
        mesh.vertices.push_back(root);
        mesh.vertices.push_back(tip);
        mesh.vertices.emplace_back(root + 1e-8F * random.direction());
        mesh.triangles.push_back({first, first + 1, first + 2});
    }
    // A sound one, or nothing would be left of a mesh whose needles count as degenerate.
    mesh.vertices.insert(mesh.vertices.end(), {{0, 0, 0}, {0.5F, 0, 0}, {0, 0.5F, 0}});
    const auto last = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.triangles.push_back({last - 3, last - 2, last - 1});
    return mesh;
}

scenes::Mesh copiesOfOne(int count) {
    scenes::Mesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles.assign(static_cast<std::size_t>(count), {0, 1, 2});
    return mesh;
}

double sizeOf(const Tree& tree) {
    return (tree.upper.cast<double>() - tree.lower.cast<double>()).norm();
}

std::vector<InstructionSet> instructionSets() {
    const InstructionSetGuard guard;
    std::vector<InstructionSet> sets;
    for (const InstructionSet set : {InstructionSet::scalar, InstructionSet::avx2, InstructionSet::avx512}) {
        if (limitInstructionSet(set) == set) {
            sets.push_back(set);
        }
    }
    return sets;
}

}  // namespace grapeshot::test
