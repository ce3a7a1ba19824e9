#include <grapeshot/scf/detail/track_step.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

#include <grapeshot/scf/detail/prefetch.hpp>

namespace grapeshot::detail {
namespace {

constexpr double trackedShare = 0.6;  // of the budget, for what is known already
constexpr double frontShare = 0.5;    // of what is left then
constexpr int descentUnits = 24;
constexpr std::uint64_t stepsBetweenWalks = 4;  // from the same contact
constexpr std::uint32_t divesPerRound = 64;
constexpr double caution = 0.75;  // what is not finished counts as a hit
constexpr float priceMemory = 0.9F;

Eigen::Vector3f normalOf(const PairBatch& batch, int lane) {
    const DistanceBatch& out = batch.out();
    const Eigen::Vector3f d(out.onA[0][lane] - out.onB[0][lane], out.onA[1][lane] - out.onB[1][lane],
                            out.onA[2][lane] - out.onB[2][lane]);
    const float length = d.norm();
    if ((out.overlapping >> static_cast<unsigned>(lane) & 1U) == 0U && length > 1e-12F) {
        return d / length;
    }
    const Eigen::Vector3f u = batch.cornerOfB(1, lane) - batch.cornerOfB(0, lane);
    const Eigen::Vector3f v = batch.cornerOfB(2, lane) - batch.cornerOfB(0, lane);
    const Eigen::Vector3f n(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]);
    const float area = n.norm();
    return area > 0 ? Eigen::Vector3f(n / area) : Eigen::Vector3f::UnitY();
}

TrackedContact contactOf(const PairBatch& batch, int lane) {
    const DistanceBatch& out = batch.out();
    TrackedContact contact;
    contact.pair = batch.pair(lane);
    contact.onA = {out.onA[0][lane], out.onA[1][lane], out.onA[2][lane]};
    contact.onB = {out.onB[0][lane], out.onB[1][lane], out.onB[2][lane]};
    contact.normal = normalOf(batch, lane);
    contact.signedDistance = out.signedDistance[lane];
    contact.featureA = static_cast<std::uint8_t>(out.featureA[lane]);
    contact.featureB = static_cast<std::uint8_t>(out.featureB[lane]);
    contact.overlapping = (out.overlapping >> static_cast<unsigned>(lane) & 1U) != 0U;
    return contact;
}

std::uint64_t shareOf(std::uint64_t units, double share) {
    return units == unlimited ? unlimited : static_cast<std::uint64_t>(static_cast<double>(units) * share);
}

}  // namespace

TrackStep::TrackStep(const PairSpace& space, const TrackSettings& settings, const Budget& budget, TrackerMemory& memory,
                     TrackerScratch& scratch, TrackResult& out)
    : m_space(space),
      m_settings(settings),
      m_meter(budget),
      m_memory(memory),
      m_scratch(scratch),
      m_out(out),
      m_cellsA(scratch.spacingA),
      m_cellsB(space.isSelf() ? scratch.spacingA : scratch.spacingB),
      m_frontA(scratch.frontA),
      m_frontB(space.isSelf() ? scratch.frontA : scratch.frontB),
      m_key{settings.seed, settings.pair, memory.step},
      m_testPrice(memory.testPrice),
      m_untested(memory.tracked.size()) {
    scratch.search.resetWork();
    scratch.batch.clear();
    scratch.batch.forget();
    scratch.contacts.clear();
    scratch.nearPairs.clear();
    scratch.tried.clear();
    scratch.candidateOf.clear();
    scratch.found.clear();
    scratch.kept.clear();
    scratch.near.clear();
    scratch.candidates.clear();
    scratch.toWalk.clear();
}

bool TrackStep::isFinite() const {
    return m_space.a->isFinite() && m_space.b->isFinite() && m_scratch.batch.isFinite();
}

std::uint64_t TrackStep::keyOf(const TrianglePair& pair) const {
    std::uint32_t a = m_cellsA.idOf(m_space.a->tree(), pair.triangleA);
    std::uint32_t b = m_cellsB.idOf(m_space.b->tree(), pair.triangleB);
    if (m_space.isSelf() && a > b) {
        std::swap(a, b);
    }
    return joined(a, b);
}

std::uint64_t TrackStep::cellKey(const Cells& a, const Cells& b, const TrianglePair& pair) const {
    std::uint32_t cellA = a.cellOf(m_space.a->tree(), pair.triangleA);
    std::uint32_t cellB = b.cellOf(m_space.b->tree(), pair.triangleB);
    if (m_space.isSelf() && cellA > cellB) {
        std::swap(cellA, cellB);
    }
    return joined(cellA, cellB);
}

void TrackStep::markReported(const TrianglePair& pair) {
    if (m_scratch.candidates.empty()) {
        return;
    }
    if (const std::uint32_t* index = m_scratch.candidateOf.find(cellKey(m_frontA, m_frontB, pair))) {
        bool& isReported = m_scratch.candidates[*index].isReported;
        m_out.miss.reported += isReported ? 0 : 1;
        isReported = true;
    }
}

bool TrackStep::accept(const PairBatch& batch, int lane, std::uint64_t birth) {
    const TrianglePair& pair = batch.pair(lane);
    m_lastKey = keyOf(pair);
    const auto index = static_cast<std::uint32_t>(m_out.contacts.size());
    if (!m_scratch.contacts.insert(m_lastKey, index).isNew) {
        return false;
    }
    m_out.contacts.push_back(contactOf(batch, lane));
    m_out.contacts.back().age = static_cast<std::uint32_t>(m_memory.step - birth);
    m_scratch.kept.push_back({pair, birth});
    m_scratch.tried.insert(cellKey(m_cellsA, m_cellsB, pair), 0);
    m_scratch.toWalk.push_back(index);
    markReported(pair);
    return true;
}

void TrackStep::report(const PairBatch& batch, int lane) {
    if (!accept(batch, lane, m_memory.step)) {
        m_out.contacts.push_back(contactOf(batch, lane));
        markReported(batch.pair(lane));
    }
}

void TrackStep::keepNear(const TrianglePair& pair, std::uint64_t birth) {
    const std::uint64_t key = keyOf(pair);
    if (m_scratch.contacts.find(key) == nullptr &&
        m_scratch.nearPairs.insert(key, static_cast<std::uint32_t>(m_scratch.near.size())).isNew) {
        m_scratch.near.push_back({pair, birth});
    }
}

void TrackStep::finish() {
    std::vector<TrackedPair>& tracked = m_memory.tracked;
    tracked.erase(tracked.begin(), tracked.begin() + static_cast<std::ptrdiff_t>(m_untested));
    m_out.carried = static_cast<std::uint32_t>(tracked.size());
    tracked.insert(tracked.end(), m_scratch.kept.begin(), m_scratch.kept.end());
    for (const TrackedPair& near : m_scratch.near) {
        if (m_scratch.contacts.find(keyOf(near.pair)) == nullptr) {
            tracked.push_back(near);
        }
    }
    m_out.tracked = static_cast<std::uint32_t>(tracked.size());
    m_memory.testPrice = m_testPrice;
    ++m_memory.step;
}

void TrackStep::exact() {
    m_untested = m_memory.tracked.size();
    const SearchEnd end = m_scratch.search.runUntil(
        m_space, {0, 0}, false, [&] { return left() == 0; },
        [&](const PairBatch& batch, int lane) {
            m_out.contacts.push_back(contactOf(batch, lane));
            return true;
        });
    m_out.certain = end == SearchEnd::exhausted;
    m_out.stop = m_out.certain ? StopReason::certain : StopReason::budget;
}

void TrackStep::resolution() {
    testTracked(1);
    bool complete = m_out.carried == 0;
    const bool all = m_scratch.front.run(
        m_space, m_cellsA, m_cellsB, m_work,
        [&](const BallPair& pair, float) {
            const bool coarse = isCoarse(pair);
            // Of a coarse mesh every pair of triangles counts, not only the first.
            if (!coarse && m_scratch.tried.find(joined(m_cellsA.cellAt(pair.a), m_cellsB.cellAt(pair.b))) != nullptr) {
                return true;
            }
            const SearchEnd end = m_scratch.search.runUntil(
                m_space, pair, true, [&] { return left() == 0; },
                [&](const PairBatch& batch, int lane) {
                    accept(batch, lane, m_memory.step);
                    return coarse;
                });
            complete = complete && end != SearchEnd::limited;
            return end != SearchEnd::limited;
        },
        [&] { return left() > 0; });
    m_out.certain = complete && all;
    m_out.stop = m_out.certain ? StopReason::certain : StopReason::budget;
}

void TrackStep::sampled() {
    testTracked(trackedShare);
    const std::uint64_t afterTracked = left();
    const bool complete = listCandidates(shareOf(afterTracked, frontShare));
    m_out.miss.candidates = m_scratch.candidates.size();
    for (const TrackedContact& contact : m_out.contacts) {
        markReported(contact.pair);
    }
    // What the uniform sample needs stays; it comes last, because nothing may be found after it was drawn.
    const std::uint64_t spare = shareOf(left(), static_cast<double>(m_settings.auditShare));
    if (!m_scratch.candidates.empty()) {
        walk(spare);
        diveOn(spare);
    }
    audit(complete);
}

void TrackStep::testTracked(double share) {
    PairBatch& batch = m_scratch.batch;
    const std::vector<TrackedPair>& tracked = m_memory.tracked;
    const std::uint64_t limit = shareOf(left(), share);
    struct Parted {
        VertexPair corners;
        TrackedPair tracked;
    };
    std::vector<Parted> toFollow;
    std::size_t next = 0;
    while (next < tracked.size() && left() > 0 && (limit == unlimited || m_work < limit)) {
        const std::size_t first = next;
        while (next < tracked.size() && !batch.isFull()) {
            if (next + 2 * batchWidth < tracked.size()) {
                prefetchTriangles(m_space, tracked[next + 2 * batchWidth].pair);
            }
            if (next + batchWidth < tracked.size()) {
                prefetchCorners(m_space, tracked[next + batchWidth].pair);
            }
            batch.add(m_space, tracked[next++].pair);
        }
        ++m_work;
        const int count = batch.run(m_space.reach + m_settings.followDistance + m_settings.spacing);
        for (int lane = 0; lane < count; ++lane) {
            const TrackedPair& one = tracked[first + static_cast<std::size_t>(lane)];
            const float distance = batch.out().signedDistance[lane];
            if (distance <= m_space.reach) {
                accept(batch, lane, one.birth);
            } else if (distance <= m_space.reach + m_settings.followDistance + m_settings.spacing) {
                toFollow.push_back({nearestCorners(m_space, one.pair), one});
                prefetchLists(m_space, toFollow.back().corners);
            }
        }
    }
    m_untested = next;
    m_out.carried = static_cast<std::uint32_t>(tracked.size() - next);
    for (std::size_t i = 0; i < toFollow.size(); ++i) {
        if (i + 2 < toFollow.size()) {
            prefetchAround(m_space, toFollow[i + 2].corners);
        }
        const auto& [corners, one] = toFollow[i];
        if (left() == 0 || (limit != unlimited && m_work >= limit)) {
            keepNear(one.pair, one.birth);
        } else {
            repair(corners, one.birth);
        }
    }
}

bool TrackStep::repair(const VertexPair& from, std::uint64_t birth) {
    return testFans(descend(m_space, from.a, from.b, descentUnits, m_work), birth);
}

bool TrackStep::isCoarse(const BallPair& pair) const {
    return (isBallLeaf(pair.a) && m_cellsA.coarse[ballIndex(pair.a)] != 0) ||
           (isBallLeaf(pair.b) && m_cellsB.coarse[ballIndex(pair.b)] != 0);
}

bool TrackStep::isLeftOut(const TrianglePair& pair) const {
    if (!m_space.isSelf()) {
        return false;
    }
    if (m_space.excludes(pair.triangleA, pair.triangleB)) {
        return true;
    }
    const Surface& surface = m_space.a->tree().surface;
    const auto middle = [&](std::uint32_t t) {
        const Triangle& corners = surface.triangles[t];
        return Eigen::Vector3f((surface.rest[corners[0]] + surface.rest[corners[1]] + surface.rest[corners[2]]) / 3);
    };
    return (middle(pair.triangleA) - middle(pair.triangleB)).squaredNorm() <= m_space.exclusion * m_space.exclusion;
}

bool TrackStep::isFarAtRest(const VertexPair& vertices) const {
    if (!m_space.isSelf()) {
        return true;
    }
    const Surface& surface = m_space.a->tree().surface;
    const float least = m_space.exclusion + 2 * surface.longestEdge;
    return (surface.rest[vertices.a] - surface.rest[vertices.b]).squaredNorm() > least * least;
}

bool TrackStep::testFans(const VertexPair& vertices, std::uint64_t birth) {
    const auto longestEdge = [](const PosedTree& side, std::uint32_t vertex) {
        const Eigen::Vector3f from = side.point(vertex);
        float square = 0;
        for (const std::uint32_t other : side.tree().surface.ring.of(vertex)) {
            square = std::max(square, (side.point(other) - from).squaredNorm());
        }
        return std::sqrt(square);
    };
    const float interesting = m_space.reach + m_settings.followDistance;
    if (std::sqrt(vertices.square) >
        interesting + longestEdge(*m_space.a, vertices.a) + longestEdge(*m_space.b, vertices.b)) {
        return false;
    }
    PairBatch& batch = m_scratch.batch;
    TrianglePair nearest;
    float nearestDistance = interesting;
    bool isContact = false;
    const auto run = [&] {
        ++m_work;
        const int count = batch.run(interesting);
        for (int lane = 0; lane < count && !isContact; ++lane) {
            const float distance = batch.out().signedDistance[lane];
            if (distance <= m_space.reach) {
                accept(batch, lane, birth);
                isContact = true;
            } else if (distance <= nearestDistance) {
                nearest = batch.pair(lane);
                nearestDistance = distance;
            }
        }
    };
    const bool isFar = isFarAtRest(vertices);
    for (const std::uint32_t a : m_space.a->tree().surface.fan.of(vertices.a)) {
        for (const std::uint32_t b : m_space.b->tree().surface.fan.of(vertices.b)) {
            if (!isFar && isLeftOut({a, b})) {
                continue;
            }
            batch.add(m_space, {a, b});
            if (batch.isFull()) {
                run();
                if (isContact) {
                    return true;
                }
            }
        }
    }
    if (batch.size() > 0) {
        run();
    }
    if (!isContact && nearest.triangleA != noTriangle && m_settings.followDistance > 0) {
        keepNear(nearest, birth);
    }
    return isContact;
}

bool TrackStep::listCandidates(std::uint64_t limit) {
    const std::uint64_t first = work();
    std::vector<Candidate>& candidates = m_scratch.candidates;
    return m_scratch.front.run(
        m_space, m_frontA, m_frontB, m_work,
        [&](const BallPair& pair, float weight) {
            m_scratch.candidateOf.insert(joined(m_frontA.cellAt(pair.a), m_frontB.cellAt(pair.b)),
                                         static_cast<std::uint32_t>(candidates.size()));
            candidates.push_back({pair, weight, false});
            return true;
        },
        [&] { return left() > 0 && (limit == unlimited || work() - first < limit); });
}

void TrackStep::sumWeights() {
    const std::vector<Candidate>& candidates = m_scratch.candidates;
    double total = 0;
    for (const Candidate& candidate : candidates) {
        total += static_cast<double>(candidate.weight) * static_cast<double>(candidate.weight);
    }
    constexpr double uniform = 0.25;
    const double each = (total > 0 ? uniform : 1) / static_cast<double>(candidates.size());
    const double scale = total > 0 ? (1 - uniform) / total : 0;
    m_scratch.cumulative.resize(candidates.size());
    double sum = 0;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        const auto weight = static_cast<double>(candidates[i].weight);
        sum += each + scale * weight * weight;
        m_scratch.cumulative[i] = sum;
    }
}

BallPair TrackStep::drawCandidate(double place) const {
    const std::vector<double>& sums = m_scratch.cumulative;
    const auto found = std::upper_bound(sums.begin(), sums.end(), place * sums.back());
    const auto index = std::min(static_cast<std::size_t>(found - sums.begin()), sums.size() - 1);
    return m_scratch.candidates[index].cells;
}

bool TrackStep::dive(BallPair pair, bool greedy) {
    ChildPairs children;
    float weight[16];
    while (!isBallLeaf(pair.a) || !isBallLeaf(pair.b)) {
        m_work += m_space.expand(pair, children, &weight);
        if (children.mask == 0) {
            return false;
        }
        unsigned chosen = 16;
        if (greedy) {
            for (std::uint32_t rest = children.mask; rest != 0U; rest &= rest - 1U) {
                const auto lane = static_cast<unsigned>(std::countr_zero(rest));
                chosen = chosen == 16 || weight[lane] > weight[chosen] ? lane : chosen;
            }
        } else {
            float sum = 0;
            for (std::uint32_t rest = children.mask; rest != 0U; rest &= rest - 1U) {
                const auto lane = static_cast<unsigned>(std::countr_zero(rest));
                sum += weight[lane] * weight[lane];
            }
            float place = unit() * sum;
            for (std::uint32_t rest = children.mask; rest != 0U; rest &= rest - 1U) {
                const auto lane = static_cast<unsigned>(std::countr_zero(rest));
                chosen = lane;
                place -= weight[lane] * weight[lane];
                if (place < 0) {
                    break;
                }
            }
        }
        pair = children.at(chosen);
    }
    const BallTree& treeA = m_space.a->tree();
    const BallTree& treeB = m_space.b->tree();
    const bool coarse = isCoarse(pair);
    bool found = false;
    std::uint64_t key = 0;
    m_scratch.search.runLeaves(m_space, ballIndex(pair.a), ballIndex(pair.b), true,
                               [&](const PairBatch& batch, int lane) {
                                   accept(batch, lane, m_memory.step);
                                   key = found ? key : m_lastKey;
                                   found = true;
                                   return coarse;
                               });
    if (found) {
        m_lastKey = key;
        return true;
    }
    if (greedy) {
        return false;  // beside a contact a descent leads back to it
    }
    const TrianglePair nearest = m_scratch.search.nearest();
    const VertexPair from = nearest.triangleA != noTriangle
                                ? nearestCorners(m_space, nearest)
                                : VertexPair{treeA.own(pair.a).center, treeB.own(pair.b).center, 0};
    if (m_space.isSelf() && (treeA.surface.rest[from.a] - treeA.surface.rest[from.b]).squaredNorm() <=
                                m_space.exclusion * m_space.exclusion) {
        return false;
    }
    return repair(from, m_memory.step);
}

void TrackStep::walkFrom(std::uint32_t contact) {
    const TrianglePair pair = m_out.contacts[contact].pair;
    const auto around = [&](PosedTree& side, const Cells& cells, std::uint32_t triangle, FourBalls& balls,
                            std::uint32_t(&list)[4]) {
        const std::uint32_t cell = cells.cellOf(side.tree(), triangle);
        const auto neighbours = cells.neighbours.of(cell);
        unsigned count = 0;
        list[count++] = cell;
        const std::uint64_t start = neighbours.empty() ? 0 : below(neighbours.size());
        for (std::size_t i = 0; i < neighbours.size() && count < 4; ++i) {
            list[count++] = neighbours[(start + i) % neighbours.size()];
        }
        for (unsigned slot = 0; slot < count; ++slot) {
            side.putBall(cells.cells[list[slot]], balls, static_cast<int>(slot));
        }
        return count;
    };
    FourBalls ballsA{};
    FourBalls ballsB{};
    std::uint32_t listA[4];
    std::uint32_t listB[4];
    const unsigned countA = around(*m_space.a, m_cellsA, pair.triangleA, ballsA, listA);
    const unsigned countB = around(*m_space.b, m_cellsB, pair.triangleB, ballsB, listB);
    float weight[16];
    std::uint32_t mask = overlappingBalls(ballsA, ballsB, m_space.reach, weight);
    ++m_work;
    for (unsigned lane = 0; lane < 16; ++lane) {
        if (lane >> 2U >= countA || (lane & 3U) >= countB) {
            mask &= ~(1U << lane);
        }
    }
    for (bool looked = false; !looked && mask != 0;) {
        unsigned best = 16;
        for (std::uint32_t rest = mask; rest != 0U; rest &= rest - 1U) {
            const auto lane = static_cast<unsigned>(std::countr_zero(rest));
            best = best == 16 || weight[lane] > weight[best] ? lane : best;
        }
        mask &= ~(1U << best);
        std::uint32_t cellA = listA[best >> 2U];
        std::uint32_t cellB = listB[best & 3U];
        if (m_space.isSelf() && cellA > cellB) {
            std::swap(cellA, cellB);
        }
        if (m_scratch.tried.insert(joined(cellA, cellB), 0).isNew) {
            looked = true;
            dive({m_cellsA.cells[cellA], m_cellsB.cells[cellB]}, true);
        }
    }
}

void TrackStep::walk(std::uint64_t spare) {
    // Old contacts in an order that changes from step to step, so that each has its turn when the budget is short;
    // those found meanwhile come after them.
    std::vector<std::uint32_t>& queue = m_scratch.toWalk;
    if (!queue.empty()) {
        std::rotate(queue.begin(), queue.begin() + static_cast<std::ptrdiff_t>(below(queue.size())), queue.end());
    }
    std::erase_if(queue, [&](std::uint32_t i) {
        const TrackedContact& contact = m_out.contacts[i];
        return contact.age > 0 && (contact.pair.triangleA + m_memory.step) % stepsBetweenWalks != 0;
    });
    const std::uint64_t all = left();
    const std::uint64_t stop = all == unlimited ? 0 : std::max(spare, (all + spare) / 2);
    std::size_t next = 0;
    while (next < queue.size() && left() > stop) {
        walkFrom(queue[next++]);
    }
    queue.erase(queue.begin(), queue.begin() + static_cast<std::ptrdiff_t>(next));
}

void TrackStep::diveOn(std::uint64_t spare) {
    sumWeights();
    std::size_t walked = m_scratch.toWalk.size();
    const auto mayGoOn = [&] {
        const std::uint64_t rest = left();
        return rest > 0 && (rest == unlimited || rest > spare);
    };
    while (m_out.dives < m_settings.maxDives && mayGoOn()) {
        const std::uint32_t round = std::min(divesPerRound, m_settings.maxDives - m_out.dives);
        for (std::uint32_t i = 0; i < round && mayGoOn(); ++i) {
            ++m_out.dives;
            const double place = (static_cast<double>(i) + static_cast<double>(unit())) / static_cast<double>(round);
            if (dive(drawCandidate(place), false)) {
                std::uint32_t& times = m_scratch.found.insert(m_lastKey, 0).value;
                m_foundOnce += ++times == 1 ? 1 : 0;
                m_foundOnce -= times == 2 ? 1 : 0;
            }
            // What is new has neighbours that are new.
            while (walked < m_scratch.toWalk.size() && mayGoOn()) {
                walkFrom(m_scratch.toWalk[walked++]);
            }
        }
    }
    estimateUnseen(m_out.miss, m_foundOnce, m_out.dives);
}

void TrackStep::audit(bool complete) {
    std::vector<std::uint32_t>& unknown = m_scratch.unknown;
    unknown.clear();
    for (std::uint32_t i = 0; i < m_scratch.candidates.size(); ++i) {
        if (!m_scratch.candidates[i].isReported) {
            unknown.push_back(i);
        }
    }
    MissEstimate& miss = m_out.miss;
    miss.unknown = unknown.size();
    // How many is decided before the first is tested, from earlier steps' prices: to stop when the budget ends would
    // prefer the cheap ones.
    const std::uint64_t units = left();
    const double affordable =
        units == unlimited ? static_cast<double>(unknown.size())
                           : caution * static_cast<double>(units) / static_cast<double>(std::max(1.0F, m_testPrice));
    miss.sampled = m_settings.auditShare > 0
                       ? static_cast<std::uint64_t>(std::min(affordable, static_cast<double>(unknown.size())))
                       : 0;
    std::uint64_t spent = 0;
    for (std::size_t i = 0; i < miss.sampled; ++i) {
        std::swap(unknown[i], unknown[i + below(unknown.size() - i)]);
        if (left() == 0) {
            ++miss.open;
            continue;
        }
        const std::uint64_t begin = work();
        const SearchEnd end = m_scratch.search.runUntil(
            m_space, m_scratch.candidates[unknown[i]].cells, true, [&] { return left() == 0; },
            [&](const PairBatch& batch, int lane) {
                report(batch, lane);
                return false;
            });
        spent += work() - begin;
        miss.open += end == SearchEnd::limited ? 1 : 0;
        miss.hits += end == SearchEnd::stopped ? 1 : 0;
    }
    if (miss.sampled > 0) {
        const float price =
            static_cast<float>(spent) / static_cast<float>(std::max<std::uint64_t>(1, miss.sampled - miss.open));
        m_testPrice = priceMemory * m_testPrice + (1 - priceMemory) * price;
    }
    estimateMissed(miss, complete);
    m_out.certain = complete && m_out.carried == 0 && miss.sampled == miss.unknown && miss.open == 0;
    m_out.stop = m_out.certain ? StopReason::certain : StopReason::budget;
}

}  // namespace grapeshot::detail
