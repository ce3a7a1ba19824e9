#include <grapeshot/narrowphase/detail/patch_walk.hpp>

#include <algorithm>

namespace grapeshot::detail {
namespace {

constexpr std::uint64_t looksPerUnit = 16;

}  // namespace

void PatchWalk::start(const MeshModel& a, const MeshModel& b) {
    m_a = &a;
    m_b = &b;
    m_seen.clear();
    m_open.clear();
    m_next = 0;
    m_reached.clear();
    m_looks = 0;
}

void PatchWalk::seed(const LeafPair& pair) {
    std::uint32_t& known = m_seen.at({pair.leafA, pair.leafB}, 0);
    if (known == 0) {
        known = 1;
        m_open.push_back(pair);
    }
}

void PatchWalk::addNeighbours(const MeshModel& model, std::uint32_t leaf) {
    m_neighbours.clear();
    for (const std::uint32_t triangle : model.tree.leaves[leaf].triangle) {
        if (triangle == noTriangle) {
            continue;
        }
        for (const std::uint32_t across : model.topology.across[triangle]) {
            const std::uint32_t other = across != noNeighbour ? model.leafOf[across] : leaf;
            if (other != leaf && std::ranges::find(m_neighbours, other) == m_neighbours.end()) {
                m_neighbours.push_back(other);
            }
        }
    }
}

bool PatchWalk::run(Purse& purse, LocalContactSearch& search) {
    const auto payLooks = [&] {
        const std::uint64_t units = std::min(m_looks / looksPerUnit, purse.left().work);
        purse.pay(units);
        m_looks -= units * looksPerUnit;
    };
    while (m_next < m_open.size()) {
        payLooks();
        if (purse.isEmpty()) {
            return false;
        }
        const auto some =
            std::span(m_open).subspan(m_next, std::min(LocalContactSearch::fewPairs, m_open.size() - m_next));
        const std::size_t count = some.size();
        const std::uint64_t before = search.work();
        std::uint32_t near = 0;
        const std::size_t done = search.addFew(some, purse.left().work, near);
        m_looks += done;
        purse.pay(search.work() - before);
        for (std::size_t i = 0; i < done; ++i, ++m_next) {
            if ((near >> i & 1U) != 0) {
                spreadFrom(m_open[m_next]);
            }
        }
        if (done < count) {
            return false;
        }
    }
    payLooks();
    return true;
}

void PatchWalk::spreadFrom(LeafPair pair) {
    m_reached.push_back(pair);
    addNeighbours(*m_a, pair.leafA);
    for (const std::uint32_t leaf : m_neighbours) {
        seed({leaf, pair.leafB});
    }
    addNeighbours(*m_b, pair.leafB);
    for (const std::uint32_t leaf : m_neighbours) {
        seed({pair.leafA, leaf});
    }
}

}  // namespace grapeshot::detail
