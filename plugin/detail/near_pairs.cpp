#include <grapeshot/plugin/detail/near_pairs.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

using Positions = std::span<const Eigen::Vector3f>;
using Eigen::Vector3f;

struct Bounds {
    Vector3f low = Vector3f::Constant(3e38F), high = Vector3f::Constant(-3e38F);
    void add(const Vector3f& p) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
};

Bounds boundsOf(const SurfaceInStep& body) {
    Bounds bounds;
    for (const Positions part : {body.last, body.before, body.after}) {
        for (const Vector3f& p : part) {
            bounds.add(p);
        }
        if (body.rigid) {
            break;
        }
    }
    return bounds;
}

/// Longest ways of vertices from `from` to `to` that come near the box.
float motion(const SurfaceInStep& body, Positions from, Positions to, const Bounds& box, float distance) {
    if (body.rigid) {
        return 0;
    }
    float most = 0;
    for (std::size_t i = 0; i < from.size(); ++i) {
        const float square = (to[i] - from[i]).squaredNorm();
        if (square > most) {
            const Vector3f low = from[i].cwiseMin(to[i]);
            const Vector3f high = from[i].cwiseMax(to[i]);
            const bool near =
                ((low - box.high).array() <= distance).all() && ((box.low - high).array() <= distance).all();
            most = near ? square : most;
        }
    }
    return std::sqrt(most);
}

Tracker makeTracker(const BallTree& a, const BallTree& b) {
    return &a == &b ? Tracker(a) : Tracker(a, b);
}

constexpr int mostMoments = 48;  // per way
/// Of the list of neighbours, of the distance: see NeighbourSettings.
constexpr float slackOfDistance = 1;

}  // namespace

/// Everything between two times of the step is within `reach` of it.
struct NearPairs::Moment {
    Positions fromA, toA, fromB, toB;
    bool rigidA, rigidB;
    float time;
    float reach;
};

NearPairs::NearPairs(std::shared_ptr<const BallTree> a, std::shared_ptr<const BallTree> b)
    : m_a(std::move(a)), m_b(std::move(b)), m_tracker(makeTracker(*m_a, *m_b)), m_list(*m_a) {}

NearResult NearPairs::find(const SurfaceInStep& a, const SurfaceInStep& b, const NearSettings& settings,
                           std::vector<TrianglePair>& pairs) {
    pairs.clear();
    if (m_a == m_b && settings.budget.work == unlimited && settings.budget.time == never) {
        return findItself(a, settings, pairs);
    }
    if (b.rigid && settings.budget.work == unlimited && settings.budget.time == never) {
        return findBeside(a, settings, pairs);
    }
    NearResult result;
    result.stop = StopReason::certain;
    result.certain = true;
    const Bounds boxA = boundsOf(a);
    const Bounds boxB = boundsOf(b);
    // A long edge reaches the box though its ends do not.
    const float beyond = settings.distance + m_a->surface.longestEdge + m_b->surface.longestEdge;
    const auto way = [&](Positions SurfaceInStep::*from, Positions SurfaceInStep::*to) {
        return motion(a, a.*from, a.*to, boxB, beyond) + motion(b, b.*from, b.*to, boxA, beyond);
    };
    const std::array ways{way(&SurfaceInStep::last, &SurfaceInStep::before),
                          way(&SurfaceInStep::before, &SurfaceInStep::after)};
    const float unit = std::max({settings.distance, settings.spacing, 1e-6F});
    const float most = std::max(ways[0], ways[1]);
    if (most <= unit) {
        look({a.before, a.before, b.before, b.before, a.rigid, b.rigid, 0, settings.distance + most}, settings, result,
             pairs);
    } else {
        result.isWhole = true;
        NearSettings all = settings;
        all.budget = {};
        for (std::size_t leg = 0; leg < 2; ++leg) {
            const float wanted = std::max(1.0F, std::ceil(ways[leg] / (2 * unit)));
            const float count = std::min(wanted, static_cast<float>(mostMoments));
            const int moments = static_cast<int>(count);
            // What is faster than that has blown up, and would bring everything near everything.
            const float between = std::min(0.5F * ways[leg] / count, unit);
            result.certain = result.certain && wanted <= count;
            for (int k = 0; k < moments; ++k) {
                const float time = (static_cast<float>(k) + 0.5F) / count;
                const float reach = settings.distance + between;
                look({leg == 0 ? a.last : a.before, leg == 0 ? a.before : a.after, leg == 0 ? b.last : b.before,
                      leg == 0 ? b.before : b.after, a.rigid, b.rigid, time, reach},
                     all, result, pairs);
            }
        }
    }
    std::ranges::sort(pairs);
    const auto repeated = std::ranges::unique(pairs);
    pairs.erase(repeated.begin(), repeated.end());
    return result;
}

NearResult NearPairs::findBeside(const SurfaceInStep& a, const NearSettings& settings,
                                 std::vector<TrianglePair>& pairs) {
    if (!m_beside) {
        m_beside.emplace(*m_a, *m_b);
    }
    const std::array moments{a.last, a.before, a.after};
    NearResult result;
    const float rounding = 1e-6F * (m_a->extent + m_b->extent);
    result.work = m_beside->find(moments, settings.distance + rounding, pairs);
    result.certain = true;
    result.stop = StopReason::certain;
    std::ranges::sort(pairs);
    return result;
}

NearResult NearPairs::findItself(const SurfaceInStep& body, const NearSettings& settings,
                                 std::vector<TrianglePair>& pairs) {
    const float distance = std::max(settings.distance, 1e-6F * m_a->extent);
    m_list.find(body.last, body.before, body.after, {distance, slackOfDistance * distance, settings.exclusion},
                m_listed);
    NearResult result;
    result.work = m_listed.work;
    result.fault = m_listed.fault;
    result.certain = !m_listed.fault;
    result.stop = m_listed.fault ? StopReason::invalidInput : StopReason::certain;
    if (settings.thin) {
        m_thin.find(*m_a, body, m_listed.pairs, distance, settings.spacing, settings.near, pairs);
    } else {
        pairs.swap(m_listed.pairs);
        std::ranges::sort(pairs);
    }
    return result;
}

void NearPairs::look(const Moment& moment, const NearSettings& settings, NearResult& result,
                     std::vector<TrianglePair>& pairs) {
    const auto stateOf = [&](Positions from, Positions to, bool rigid, std::vector<Vector3f>& positions) {
        if (rigid) {
            return rigidState();
        }
        if (moment.time == 0) {
            return SurfaceState{from, std::nullopt, Stretch::measured(), {}};
        }
        positions.resize(from.size());
        for (std::size_t i = 0; i < from.size(); ++i) {
            positions[i] = from[i] + moment.time * (to[i] - from[i]);
        }
        return SurfaceState{positions, std::nullopt, Stretch::measured(), {}};
    };
    TrackSettings track;
    track.mode =
        settings.budget.work == unlimited && settings.budget.time == never ? TrackMode::exact : TrackMode::budget;
    // Rounding of positions, and of the moment's place between its ends.
    track.maxDistance = moment.reach * 1.0001F + 1e-6F * m_a->extent;
    track.spacing = std::max(settings.spacing, 1e-6F);
    track.followDistance = track.maxDistance;
    track.exclusion = settings.exclusion;
    track.seed = settings.seed;
    track.pair = settings.pair;
    const SurfaceState stateA = stateOf(moment.fromA, moment.toA, moment.rigidA, m_positionsA);
    if (m_a == m_b) {
        m_tracker.step(stateA, track, settings.budget, m_found);
    } else {
        m_tracker.step(stateA, stateOf(moment.fromB, moment.toB, moment.rigidB, m_positionsB), track, settings.budget,
                       m_found);
    }
    result.work += m_found.work;
    result.certain = result.certain && m_found.certain && track.mode == TrackMode::exact;
    result.miss = m_found.miss;
    if (m_found.stop == StopReason::invalidInput || m_found.stop == StopReason::budget) {
        result.stop = result.stop == StopReason::invalidInput ? result.stop : m_found.stop;
    }
    result.fault = result.fault ? result.fault : m_found.fault;
    for (const TrackedContact& contact : m_found.contacts) {
        pairs.push_back(contact.pair);
    }
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
