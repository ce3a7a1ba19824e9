#include <grapeshot/scf/detail/geodesics.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace grapeshot::detail {
namespace {

constexpr std::size_t unlimitedVisits = std::numeric_limits<std::size_t>::max();

}  // namespace

Geodesics::Geodesics(const Surface& surface) : m_surface(surface), m_labels(surface.rest.size()) {
    double squares = 0;
    for (const float square : surface.edgeSquare) {
        squares += static_cast<double>(square);
    }
    if (squares > 0) {
        m_width = std::sqrt(squares / static_cast<double>(surface.edgeSquare.size()));
    }
}

void Geodesics::setGoals(std::span<const std::uint32_t> vertices) {
    ++m_goals;
    m_goalList.assign(vertices.begin(), vertices.end());
    for (const std::uint32_t vertex : vertices) {
        m_labels[vertex].goal = m_goals;
    }
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

bool Geodesics::run(bool goalsOnly, std::size_t mostVisits) {
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
                return false;
            }
            for (const std::uint32_t other : m_surface.ring.of(entry.vertex)) {
                if (!goalsOnly || m_labels[other].goal == m_goals) {
                    const Eigen::Vector3f edge = m_surface.rest[other] - m_surface.rest[entry.vertex];
                    reach(other, entry.distance + std::sqrt(static_cast<double>(edge.squaredNorm())));
                }
            }
        }
    }
    return true;
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

bool Geodesics::withinGoals(std::uint32_t from, std::vector<double>& distances) {
    ++m_search;
    m_current = 0;
    reach(from, 0);
    run(true, unlimitedVisits);
    bool connected = true;
    double farthest = 0;
    for (const std::uint32_t goal : m_goalList) {
        if (m_labels[goal].search != m_search) {
            if (connected) {
                connected = false;
                for (const std::uint32_t other : m_goalList) {
                    if (m_labels[other].search == m_search) {
                        farthest = std::max(farthest, m_labels[other].distance);
                    }
                }
            }
            m_current = static_cast<std::uint64_t>(farthest / m_width);
            reach(goal, farthest);
            run(true, unlimitedVisits);
        }
        farthest = std::max(farthest, m_labels[goal].distance);
    }
    distances.resize(m_goalList.size());
    std::transform(m_goalList.begin(), m_goalList.end(), distances.begin(),
                   [&](std::uint32_t vertex) { return m_labels[vertex].distance; });
    return connected;
}

double Geodesics::radiusAround(std::uint32_t center) {
    ++m_search;
    m_current = 0;
    reach(center, 0);
    run(false, unlimitedVisits);
    return largestDistance();
}

double Geodesics::radiusNear(std::uint32_t center) {
    ++m_search;
    m_current = 0;
    reach(center, 0);
    run(false, 32 * m_goalList.size());
    return largestDistance();  // a label is the length of some path, also where it was stopped
}

}  // namespace grapeshot::detail
