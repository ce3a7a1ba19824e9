#include <grapeshot/scf/reference/surface.hpp>

#include <algorithm>
#include <string>

#include <grapeshot/core/error.hpp>
#include <grapeshot/core/mesh_report.hpp>
#include <grapeshot/core/topology.hpp>
#include <grapeshot/scf/reference/detail/shallow_tree.hpp>

namespace grapeshot::scf::reference {

namespace {

void append(Lists& lists, std::vector<std::uint32_t>& list) {
    std::ranges::sort(list);
    list.erase(std::unique(list.begin(), list.end()), list.end());
    lists.items.insert(lists.items.end(), list.begin(), list.end());
    lists.begin.push_back(static_cast<std::uint32_t>(lists.items.size()));
    list.clear();
}

Lists listsOf(const std::vector<std::vector<std::uint32_t>>& all) {
    Lists lists;
    for (std::vector<std::uint32_t> list : all) {
        append(lists, list);
    }
    return lists;
}

void addFinest(const Topology& topology, Surface& surface) {
    surface.featureOf.assign(topology.welded.size(), noNeighbour);
    Level level;
    std::vector<std::vector<std::uint32_t>> fans;
    for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
        for (const std::uint32_t vertex : surface.triangles[t]) {
            std::uint32_t& feature = surface.featureOf[vertex];
            if (feature == noNeighbour) {
                feature = static_cast<std::uint32_t>(level.centre.size());
                level.centre.push_back(vertex);
                fans.emplace_back();
            }
            fans[feature].push_back(t);
        }
    }
    std::vector<std::uint32_t> ring;
    for (const std::uint32_t vertex : level.centre) {
        for (const std::uint32_t other : topology.ringOf(vertex)) {
            ring.push_back(surface.featureOf[other]);
        }
        append(level.ring, ring);
    }
    surface.fan = listsOf(fans);
    surface.levels.push_back(std::move(level));
}

/// In order of number: a feature that no cluster has yet takes its free neighbours with it.
void addCoarser(Surface& surface) {
    Level& fine = surface.levels.back();
    fine.parent.assign(fine.centre.size(), noNeighbour);
    Level coarse;
    std::vector<std::uint32_t> children;
    for (std::uint32_t f = 0; f < fine.centre.size(); ++f) {
        if (fine.parent[f] != noNeighbour) {
            continue;
        }
        const auto cluster = static_cast<std::uint32_t>(coarse.centre.size());
        coarse.centre.push_back(fine.centre[f]);
        fine.parent[f] = cluster;
        children.push_back(f);
        for (const std::uint32_t neighbour : fine.ring[f]) {
            if (fine.parent[neighbour] == noNeighbour) {
                fine.parent[neighbour] = cluster;
                children.push_back(neighbour);
            }
        }
        append(coarse.children, children);
    }
    std::vector<std::uint32_t> ring;
    for (std::uint32_t c = 0; c < coarse.centre.size(); ++c) {
        for (const std::uint32_t child : coarse.children[c]) {
            for (const std::uint32_t neighbour : fine.ring[child]) {
                if (fine.parent[neighbour] != c) {
                    ring.push_back(fine.parent[neighbour]);
                }
            }
        }
        append(coarse.ring, ring);
    }
    surface.levels.push_back(std::move(coarse));
}

}  // namespace

Surface buildSurface(MeshView rest, const SurfaceSettings& settings) {
    if (settings.treeDepth < 0 || settings.treeDepth > 16) {
        throw Error(Fault::badSetting, "treeDepth is " + std::to_string(settings.treeDepth) + ", not 0 to 16",
                    "settings");
    }
    if (settings.coarsest < 1) {
        throw Error(Fault::badSetting, "coarsest is " + std::to_string(settings.coarsest) + ", not 1 or more",
                    "settings");
    }
    requireUsable(rest);
    const Topology topology = buildTopology(rest);
    Surface surface;
    surface.vertexCount = rest.vertices.size();
    for (const Triangle& t : rest.triangles) {
        surface.triangles.push_back({topology.welded[t[0]], topology.welded[t[1]], topology.welded[t[2]]});
    }
    addFinest(topology, surface);
    while (surface.levels.back().centre.size() > static_cast<std::size_t>(settings.coarsest)) {
        addCoarser(surface);
        if (surface.levels.back().centre.size() == surface.levels[surface.levels.size() - 2].centre.size()) {
            surface.levels.pop_back();
            surface.levels.back().parent.clear();
            break;
        }
    }
    surface.tree = detail::buildShallowTree(rest.vertices, surface.triangles, settings.treeDepth);
    return surface;
}

}  // namespace grapeshot::scf::reference
