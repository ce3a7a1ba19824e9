#include <grapeshot/scf/detail/geodesics.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

#include <grapeshot/scf/detail/sliced_vectors.hpp>

namespace grapeshot::detail {
namespace {

constexpr std::size_t unlimitedVisits = std::numeric_limits<std::size_t>::max();
constexpr std::size_t visitsPerUnit = 2;  ///< of vertices with six neighbours
constexpr std::size_t goalsPerUnit = 32;

}  // namespace

Sliced Geodesics::prepare() {
    co_await fillInSlices(m_labels, m_surface.rest.size(), Label{});
    m_goalList.reserve(m_surface.rest.size());
    double squares = 0;
    const auto add = [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            squares += static_cast<double>(m_surface.edgeSquare[i]);
        }
    };
    co_await inPieces(0, m_surface.edgeSquare.size(), 128, add);
    if (squares > 0) {
        m_width = std::sqrt(squares / static_cast<double>(m_surface.edgeSquare.size()));
    }
}

Sliced Geodesics::setGoals(std::span<const std::uint32_t> vertices) {
    ++m_goals;
    m_goalList.clear();
    const auto set = [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            m_goalList.push_back(vertices[i]);
            m_labels[vertices[i]].goal = m_goals;
        }
    };
    co_await inPieces(0, vertices.size(), goalsPerUnit, set);
}

void Geodesics::reach(std::uint32_t vertex, double distance) {
    Label& label = m_labels[vertex];
    if (label.search == m_search && label.distance <= distance) {
        return;
    }
    label.search = m_search;
    label.distance = distance;
    // What is beyond the last bucket waits there, and goes round again when its turn comes.
    const std::uint64_t bucket = std::min(bucketOf(distance), m_current + m_buckets.size() - 1);
    m_buckets[bucket % m_buckets.size()].push_back({distance, vertex});
    ++m_queued;
}

std::uint64_t Geodesics::bucketOf(double distance) const {
    return static_cast<std::uint64_t>(distance / m_width);
}

Sliced Geodesics::run(bool goalsOnly, std::size_t mostVisits) {
    std::size_t paid = 0;
    for (; m_queued > 0; ++m_current) {
        std::vector<Entry>& bucket = m_buckets[m_current % m_buckets.size()];
        while (!bucket.empty()) {
            const Entry entry = bucket.back();
            bucket.pop_back();
            --m_queued;
            if (m_labels[entry.vertex].distance < entry.distance) {
                continue;  // a shorter way was found since
            }
            if (bucketOf(entry.distance) > m_current) {
                m_labels[entry.vertex].distance = std::numeric_limits<double>::infinity();
                reach(entry.vertex, entry.distance);
                continue;
            }
            if (mostVisits-- == 0) {
                clear();
                co_return;
            }
            if (paid == 0) {
                // Not more than there is for small ones.
                const std::size_t next = std::min<std::size_t>(mostSlicedPiece * visitsPerUnit, m_goalList.size());
                paid = std::max<std::size_t>(1, next);
                co_yield (paid + visitsPerUnit - 1) / visitsPerUnit;
            }
            --paid;
            for (const std::uint32_t other : m_surface.ring.of(entry.vertex)) {
                if (!goalsOnly || m_labels[other].goal == m_goals) {
                    const Eigen::Vector3f edge = m_surface.rest[other] - m_surface.rest[entry.vertex];
                    reach(other, entry.distance + std::sqrt(static_cast<double>(edge.squaredNorm())));
                }
            }
        }
    }
}

void Geodesics::clear() {
    for (std::vector<Entry>& bucket : m_buckets) {
        bucket.clear();
    }
    m_queued = 0;
}

double Geodesics::largestDistance() const {
    double largest = 0;
    for (const std::uint32_t goal : m_goalList) {
        largest = std::max(largest, m_labels[goal].search == m_search ? m_labels[goal].distance
                                                                      : std::numeric_limits<double>::infinity());
    }
    return largest;
}

Sliced Geodesics::withinGoals(std::uint32_t from, std::vector<double>& distances, bool& connected) {
    ++m_search;
    m_current = 0;
    reach(from, 0);
    co_await run(true, unlimitedVisits);
    connected = true;
    double farthest = 0;
    for (std::size_t i = 0; i < m_goalList.size(); ++i) {
        if (i % goalsPerUnit == 0) {
            co_yield 1;
        }
        const std::uint32_t goal = m_goalList[i];
        if (m_labels[goal].search != m_search) {
            if (connected) {
                connected = false;
                const auto look = [&](std::size_t begin, std::size_t end) {
                    for (std::size_t k = begin; k < end; ++k) {
                        const Label& other = m_labels[m_goalList[k]];
                        farthest = other.search == m_search ? std::max(farthest, other.distance) : farthest;
                    }
                };
                co_await inPieces(0, m_goalList.size(), goalsPerUnit, look);
            }
            m_current = static_cast<std::uint64_t>(farthest / m_width);
            reach(goal, farthest);
            co_await run(true, unlimitedVisits);
        }
        farthest = std::max(farthest, m_labels[goal].distance);
    }
    distances.clear();
    const auto list = [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            distances.push_back(m_labels[m_goalList[i]].distance);
        }
    };
    co_await inPieces(0, m_goalList.size(), 2 * goalsPerUnit, list);
}

double Geodesics::radiusAround(std::uint32_t center) {
    ++m_search;
    m_current = 0;
    reach(center, 0);
    run(false, unlimitedVisits).run();
    return largestDistance();
}

Sliced Geodesics::radiusNear(std::uint32_t center, double& radius) {
    ++m_search;
    m_current = 0;
    reach(center, 0);
    co_await run(false, 32 * m_goalList.size());
    radius = largestDistance();  // a label is the length of some path, also where it was stopped
}

}  // namespace grapeshot::detail
