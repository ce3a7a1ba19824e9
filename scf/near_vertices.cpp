#include <grapeshot/scf/near_vertices.hpp>

#include <algorithm>
#include <queue>
#include <utility>

namespace grapeshot {

IndexLists nearVertices(const Surface& surface, float distance) {
    using Reached = std::pair<float, std::uint32_t>;
    IndexLists near;
    near.begin.push_back(0);
    std::vector<float> ways(surface.rest.size(), 3e38F);
    std::vector<std::uint32_t> touched;
    std::priority_queue<Reached, std::vector<Reached>, std::greater<>> front;
    for (std::uint32_t v = 0; v < surface.rest.size(); ++v) {
        touched.assign(1, v);
        ways[v] = 0;
        front.emplace(0.0F, v);
        while (!front.empty()) {
            const auto [way, from] = front.top();
            front.pop();
            if (way > ways[from]) {
                continue;
            }
            for (const std::uint32_t to : surface.ring.of(from)) {
                const float next = way + (surface.rest[to] - surface.rest[from]).norm();
                if (next < ways[to] && (next <= distance || from == v)) {
                    if (ways[to] > 2e38F) {
                        touched.push_back(to);
                    }
                    ways[to] = next;
                    if (next <= distance) {
                        front.emplace(next, to);
                    }
                }
            }
        }
        std::ranges::sort(touched);
        near.all.insert(near.all.end(), touched.begin(), touched.end());
        near.begin.push_back(static_cast<std::uint32_t>(near.all.size()));
        for (const std::uint32_t other : touched) {
            ways[other] = 3e38F;
        }
    }
    return near;
}

}  // namespace grapeshot
