// What is new: candidates, dives into them, walks from what was found.
#include <grapeshot/scf/detail/track_step.hpp>

#include <algorithm>
#include <array>
#include <bit>

#include <grapeshot/scf/detail/prefetch.hpp>

namespace grapeshot::detail {
namespace {

constexpr std::uint64_t stepsBetweenWalks = 4;  // from the same contact
constexpr std::uint32_t divesPerRound = 64;
constexpr std::uint32_t divesAtOnce = 8;

bool isDown(const BallPair& pair) {
    return isBallLeaf(pair.a) && isBallLeaf(pair.b);
}

}  // namespace

bool TrackStep::listCandidates(std::uint64_t limit) {
    const std::uint64_t first = work();
    std::vector<Candidate>& candidates = m_scratch.candidates;
    const auto list = [&](const BallPair& pair, float weight, std::uint32_t record, float slack) {
        if (slack > ahead()) {
            return true;
        }
        m_out.miss.candidates += slack > 0 ? 0 : 1;
        candidates.push_back({pair, weight, slack > 0, record});
        return true;
    };
    const auto mayGoOn = [&] { return left() > 0 && (limit == unlimited || work() - first < limit); };
    if (!m_usesFront) {
        return m_scratch.front.run(
            m_space, m_frontA, m_frontB, m_work,
            [&](const BallPair& pair, float weight) { return list(pair, weight, 0, 0); }, mayGoOn);
    }
    beginFront();
    return m_scratch.keptFront.run(
        m_space, m_work, [&](BallRef piece, int side) { return (side == 0 ? m_frontA : m_frontB).isCell(piece); }, list,
        mayGoOn);
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

bool TrackStep::goDown(BallPair& pair, bool greedy) {
    ChildPairs children;
    float weight[16];
    m_work += m_wide.expand(pair, children, &weight);
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
    return true;
}

bool TrackStep::dive(BallPair pair, bool greedy) {
    while (!isDown(pair)) {
        if (!goDown(pair, greedy)) {
            return false;
        }
    }
    return land(pair, greedy);
}

bool TrackStep::land(const BallPair& pair, bool greedy) {
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
    const TrianglePair tested = m_scratch.search.nearest();
    const VertexPair from = tested.triangleA != noTriangle
                                ? nearestCorners(m_space, tested)
                                : VertexPair{treeA.own(pair.a).center, treeB.own(pair.b).center, 0};
    if (m_space.isSelf() && (treeA.surface.rest[from.a] - treeA.surface.rest[from.b]).squaredNorm() <=
                                m_space.exclusion * m_space.exclusion) {
        return false;
    }
    return repair(from, m_memory.step);
}

void TrackStep::walkFrom(std::uint32_t contact) {
    const TrianglePair pair = m_out.contacts[contact].pair;
    const auto around = [&](PosedTree& side, const Cells& cells, CellNeighbours& listed, std::uint32_t triangle,
                            FourBalls& balls, std::uint32_t(&list)[4]) {
        const std::uint32_t cell = cells.cellOf(side.tree(), triangle);
        const auto neighbours = listed.of(side.tree(), cells, cell);
        unsigned count = 0;
        list[count++] = cell;
        const std::uint64_t start = neighbours.empty() ? 0 : below(neighbours.size());
        for (std::size_t i = 0; i < neighbours.size() && count < 4; ++i) {
            list[count++] = neighbours[(start + i) % neighbours.size()];
        }
        for (unsigned slot = 0; slot < count; ++slot) {
            side.putBall(cells.cells[list[slot]], cells.own[list[slot]], balls, static_cast<int>(slot));
        }
        return count;
    };
    FourBalls ballsA{};
    FourBalls ballsB{};
    std::uint32_t listA[4];
    std::uint32_t listB[4];
    const unsigned countA = around(*m_space.a, m_cellsA, m_scratch.aroundA, pair.triangleA, ballsA, listA);
    const unsigned countB = around(*m_space.b, m_cellsB, m_space.isSelf() ? m_scratch.aroundA : m_scratch.aroundB,
                                   pair.triangleB, ballsB, listB);
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

void TrackStep::diveTogether(std::span<BallPair> pairs, std::uint64_t spare) {
    std::array<BallPair, divesAtOnce> under{};  // not at two leaves yet
    std::copy(pairs.begin(), pairs.end(), under.begin());
    std::size_t open = pairs.size();
    // Each level is one look at memory after the other: of one dive it is waited for, of several it is not.
    std::array<BallPair, divesAtOnce> down{};
    std::size_t landing = 0;
    while (open > 0) {
        for (std::size_t i = 0; i < open; ++i) {
            prefetchPieces(m_space, under[i]);
        }
        for (std::size_t i = 0; i < open; ++i) {
            prefetchPoints(m_space, under[i]);
        }
        std::size_t stay = 0;
        for (std::size_t i = 0; i < open; ++i) {
            BallPair pair = under[i];
            if (isDown(pair)) {
                down[landing++] = pair;
                continue;
            }
            if (!mayDive(spare)) {
                return;
            }
            if (goDown(pair, false)) {
                under[stay++] = pair;
            } else {
                ++m_out.dives;
            }
        }
        open = stay;
    }
    for (std::size_t i = 0; i < landing && mayDive(spare); ++i) {
        ++m_out.dives;
        if (land(down[i], false)) {
            std::uint32_t& times = m_scratch.found.insert(m_lastKey, 0).value;
            m_foundOnce += ++times == 1 ? 1 : 0;
            m_foundOnce -= times == 2 ? 1 : 0;
        }
    }
}

void TrackStep::diveOn(std::uint64_t spare) {
    sumWeights();
    std::size_t walked = m_scratch.toWalk.size();
    std::uint32_t begun = 0;
    while (begun < m_settings.maxDives && mayDive(spare)) {
        const std::uint32_t round = std::min(divesPerRound, m_settings.maxDives - begun);
        for (std::uint32_t i = 0; i < round && mayDive(spare);) {
            std::array<BallPair, divesAtOnce> pairs;
            std::uint32_t count = 0;
            for (; count < divesAtOnce && i < round; ++i) {
                const double place =
                    (static_cast<double>(i) + static_cast<double>(unit())) / static_cast<double>(round);
                pairs[count++] = drawCandidate(place);
            }
            begun += count;
            diveTogether(std::span(pairs.data(), count), spare);
            // What is new has neighbours that are new.
            while (walked < m_scratch.toWalk.size() && mayDive(spare)) {
                walkFrom(m_scratch.toWalk[walked++]);
            }
        }
    }
    estimateUnseen(m_out.miss, m_foundOnce, m_out.dives);
}

}  // namespace grapeshot::detail
