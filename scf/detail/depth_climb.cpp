#include <grapeshot/scf/detail/depth_climb.hpp>

#include <algorithm>

namespace grapeshot::detail {
namespace {

constexpr int patience = 24;  // vertices that are looked around from without getting deeper
constexpr int exactPatience = 8;
constexpr double sameDepth = 1 - 1e-6;

}  // namespace

void DepthClimb::begin(std::size_t vertices) {
    if (m_seen.size() < vertices) {
        m_seen.resize(vertices, 0);
    }
    if (++m_round == 0) {
        std::fill(m_seen.begin(), m_seen.end(), 0);
        m_round = 1;
    }
    m_heap.clear();
}

void DepthClimb::put(const Visit& visit) {
    m_heap.push_back(visit);
    std::push_heap(m_heap.begin(), m_heap.end());
}

void DepthClimb::visit(const SurfaceProbe& from, const SurfaceProbe& onto, const ClimbStart& start,
                       std::uint64_t& work) {
    const std::uint32_t vertex = from.topology().welded[start.vertex];
    if (m_seen[vertex] == m_round) {
        return;
    }
    m_seen[vertex] = m_round;
    const Eigen::Vector3d point = from.tree().point(vertex).cast<double>();
    const Foot foot = onto.walk(start.triangle, point, work);
    const double height = start.side * onto.heightOver(foot, point);
    if (height < 0) {
        put({-height, vertex, foot.triangle, start.side, false});
    }
}

bool DepthClimb::settle(const SurfaceProbe& from, SurfaceProbe& onto, Visit& visit, std::uint64_t& work) {
    const Eigen::Vector3d point = from.tree().point(visit.vertex).cast<double>();
    const Foot foot = onto.nearest(point, onto.footOn(visit.triangle, point), work);
    visit.depth = foot.distance;
    visit.triangle = foot.triangle;
    visit.isExact = true;
    return visit.side * onto.heightOver(foot, point) < 0;
}

std::optional<DepthClimb::Visit> DepthClimb::ascend(const SurfaceProbe& from, SurfaceProbe& onto, bool exactly,
                                                    Meter& meter, std::uint64_t& work) {
    std::optional<Visit> deepest;
    int since = 0;
    const int mostSince = exactly ? exactPatience : patience;
    while (!m_heap.empty() && since <= mostSince && meter.left(work) > 0) {
        Visit next = m_heap.front();
        std::pop_heap(m_heap.begin(), m_heap.end());
        m_heap.pop_back();
        if (exactly && !next.isExact) {
            // It was put where its upper bound is, and may belong farther down.
            if (settle(from, onto, next, work)) {
                put(next);
            }
            continue;
        }
        ++since;
        if (!deepest || next.depth > deepest->depth) {
            deepest = next;
            since = 0;
        }
        for (const std::uint32_t neighbour : from.topology().ringOf(next.vertex)) {
            visit(from, onto, {neighbour, next.triangle, next.side}, work);
        }
    }
    return deepest;
}

std::optional<Summit> DepthClimb::climb(const SurfaceProbe& from, SurfaceProbe& onto,
                                        std::span<const ClimbStart> starts, bool check, Meter& meter,
                                        std::uint64_t& work) {
    const auto climbFrom = [&](std::span<const ClimbStart> some, bool exactly) {
        begin(from.tree().tree().surface.rest.size());
        for (const ClimbStart& start : some) {
            visit(from, onto, start, work);
        }
        return ascend(from, onto, exactly, meter, work);
    };
    const auto summitOf = [&](const Visit& visit) {
        const Eigen::Vector3d point = from.tree().point(visit.vertex).cast<double>();
        return Summit{visit.vertex, onto.footOn(visit.triangle, point), visit.side, visit.isExact};
    };
    std::optional<Visit> top = climbFrom(starts, false);
    if (!top) {
        return std::nullopt;
    }
    if (check && meter.left(work) > 0) {
        const double bound = top->depth;
        if (!settle(from, onto, *top, work)) {
            top = climbFrom(starts, true);
        } else if (top->depth < sameDepth * bound) {
            const ClimbStart onwards{top->vertex, top->triangle, top->side};
            top = climbFrom(std::span(&onwards, 1), true);
        }
    }
    return top ? std::optional(summitOf(*top)) : std::nullopt;
}

}  // namespace grapeshot::detail
