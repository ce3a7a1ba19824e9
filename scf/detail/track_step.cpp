#include <grapeshot/scf/detail/track_step.hpp>

#include <algorithm>
#include <limits>

namespace grapeshot::detail {
namespace {

constexpr double frontShare = 0.5;  // of what is left then
/// Of what the surfaces come nearer in a step: what is less beyond the reach is opened nevertheless, ...
constexpr float skinSteps = 1;
/// ... and it is told how far apart triangles are that are less.
constexpr float roomSteps = 8;
/// Of the spacing, in the place of what is not known yet, or of nothing.
constexpr float stillness = 1.0F / 64;
constexpr float unknownWay = std::numeric_limits<float>::infinity();

TrackedContact contactOf(const PairBatch& batch, int lane) {
    TrackedContact contact;
    batch.describe(lane, contact);
    return contact;
}

}  // namespace

TrackStep::TrackStep(const PairSpace& space, const TrackSettings& settings, const Budget& budget,
                     std::optional<float> nearer, TrackerMemory& memory, TrackerScratch& scratch, TrackResult& out)
    : m_space(space),
      m_settings(settings),
      m_meter(budget),
      m_nearer(nearer.value_or(unknownWay)),
      m_wide(space),
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
    // Where nothing is known, or moves, of what may be expected.
    m_way = m_nearer > 0 && m_nearer < unknownWay ? m_nearer : settings.spacing * stillness;
    const bool looksAhead = settings.mode == TrackMode::budget && settings.lookAhead > 0;
    m_usesFront = nearer.has_value() && (looksAhead || (settings.keepFront && m_way < fastestKept()));
    if (looksAhead && m_nearer < unknownWay) {
        m_wide.reach += std::min(settings.lookAhead * m_nearer, settings.spacing);
    }
    m_follow = std::max(settings.followDistance, ahead());
    out.nearer = m_nearer;
    scratch.search.resetWork();
    scratch.batch.clear();
    scratch.batch.forget();
    scratch.contacts.clear();
    scratch.nearPairs.clear();
    scratch.tried.clear();
    scratch.found.clear();
    scratch.kept.clear();
    scratch.near.clear();
    scratch.candidates.clear();
    scratch.toWalk.clear();
}

float TrackStep::fastestKept() const {
    if (m_settings.mode == TrackMode::budget) {
        return m_settings.spacing / 4;
    }
    return std::max(m_space.a->tree().surface.longestEdge, m_space.b->tree().surface.longestEdge) / 2;
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
    return true;
}

void TrackStep::report(const PairBatch& batch, int lane) {
    if (!accept(batch, lane, m_memory.step)) {
        m_out.contacts.push_back(contactOf(batch, lane));
    }
}

void TrackStep::keepNear(const TrianglePair& pair, std::uint64_t birth) {
    const std::uint64_t key = keyOf(pair);
    if (m_scratch.contacts.find(key) == nullptr &&
        m_scratch.nearPairs.insert(key, static_cast<std::uint32_t>(m_scratch.near.size())).isNew) {
        m_scratch.near.push_back({{pair, birth}, std::nullopt});
    }
}

void TrackStep::keepNear(const TrackedContact& nearest, std::uint64_t birth) {
    const std::size_t before = m_scratch.near.size();
    keepNear(nearest.pair, birth);
    if (m_scratch.near.size() > before && nearest.signedDistance <= m_wide.reach && ahead() > 0) {
        m_scratch.near.back().ahead = nearest;
        m_scratch.near.back().ahead->age = static_cast<std::uint32_t>(m_memory.step - birth);
    }
}

void TrackStep::finish() {
    std::vector<TrackedPair>& tracked = m_memory.tracked;
    tracked.erase(tracked.begin(), tracked.begin() + static_cast<std::ptrdiff_t>(m_untested));
    m_out.carried = static_cast<std::uint32_t>(tracked.size());
    tracked.insert(tracked.end(), m_scratch.kept.begin(), m_scratch.kept.end());
    for (const NearPair& near : m_scratch.near) {
        if (m_scratch.contacts.find(keyOf(near.tracked.pair)) == nullptr) {
            tracked.push_back(near.tracked);
            if (near.ahead) {
                m_out.ahead.push_back(*near.ahead);
            }
        }
    }
    m_out.tracked = static_cast<std::uint32_t>(tracked.size());
    m_memory.testPrice = m_testPrice;
    ++m_memory.step;
    if (m_usesFront && m_settings.keepFront) {
        m_scratch.keptFront.moveTo(m_memory.front.records);
        m_memory.front.key = frontKey();
        m_memory.front.reach = m_space.reach;
        m_out.frontKept = m_scratch.keptFront.kept();
        m_out.frontOpened = m_scratch.keptFront.opened();
    } else {
        m_memory.front.records.clear();
    }
}

FrontKey TrackStep::frontKey() const {
    const float cells = m_settings.mode == TrackMode::exact        ? 0
                        : m_settings.mode == TrackMode::resolution ? m_settings.spacing
                                                                   : static_cast<float>(m_settings.frontCells);
    return {m_settings.mode, m_space.exclusion, cells};
}

void TrackStep::beginFront() {
    const FrontMemory& before = m_memory.front;
    const float nearer = m_nearer + std::max(0.0F, m_space.reach - before.reach);
    m_scratch.keptFront.begin(before.records, before.key == frontKey() ? nearer : unknownWay,
                              std::max(skinSteps * m_way, ahead()));
}

Clearance TrackStep::clearanceToFind() const {
    return {roomSteps * m_way};
}

void TrackStep::exactByFront() {
    beginFront();
    PairSearch& search = m_scratch.search;
    search.begin();
    const auto found = [&](const PairBatch& batch, int lane) {
        m_out.contacts.push_back(contactOf(batch, lane));
        return true;
    };
    const bool all = m_scratch.keptFront.run(
        m_space, m_work, [](BallRef piece, int) { return isBallLeaf(piece); },
        [&](const BallPair& pair, float, std::uint32_t record, float slack) {
            if (slack > 0) {
                return true;
            }
            Clearance clearance;
            search.runLeaves(m_space, ballIndex(pair.a), ballIndex(pair.b), false, found, &clearance);
            m_scratch.keptFront.setSlack(record, clearance.least);
            return left() > 0;
        },
        [&] { return left() > 0; });
    m_out.certain = all && (search.isTested() || left() > 0) && search.finish(m_space, found);
    m_out.stop = m_out.certain ? StopReason::certain : StopReason::budget;
}

void TrackStep::exact() {
    m_untested = m_memory.tracked.size();
    if (m_usesFront) {
        return exactByFront();
    }
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
    const auto search = [&](const BallPair& pair, Clearance* clearance) {
        const bool coarse = isCoarse(pair);
        // Of a coarse mesh every pair of triangles counts, not only the first.
        if (!coarse && m_scratch.tried.find(joined(m_cellsA.cellAt(pair.a), m_cellsB.cellAt(pair.b))) != nullptr) {
            return SearchEnd::stopped;
        }
        bool isClear = true;
        SearchEnd end = m_scratch.search.runUntil(
            m_space, pair, true, [&] { return left() == 0; },
            [&](const PairBatch& batch, int lane) {
                accept(batch, lane, m_memory.step);
                isClear = false;
                return coarse;
            },
            clearance);
        complete = complete && end != SearchEnd::limited;
        return end == SearchEnd::exhausted && !isClear ? SearchEnd::stopped : end;
    };
    const auto mayGoOn = [&] { return left() > 0; };
    bool all = false;
    if (m_usesFront) {
        beginFront();
        all = m_scratch.keptFront.run(
            m_space, m_work, [&](BallRef piece, int side) { return (side == 0 ? m_cellsA : m_cellsB).isCell(piece); },
            [&](const BallPair& pair, float, std::uint32_t record, float slack) {
                if (slack > 0) {
                    return true;
                }
                Clearance clearance = clearanceToFind();
                const SearchEnd end = search(pair, &clearance);
                if (end == SearchEnd::exhausted) {
                    m_scratch.keptFront.setSlack(record, clearance.least);
                }
                return end != SearchEnd::limited;
            },
            mayGoOn);
    } else {
        all = m_scratch.front.run(
            m_space, m_cellsA, m_cellsB, m_work,
            [&](const BallPair& pair, float) { return search(pair, nullptr) != SearchEnd::limited; }, mayGoOn);
    }
    m_out.certain = complete && all;
    m_out.stop = m_out.certain ? StopReason::certain : StopReason::budget;
}

void TrackStep::sampled() {
    testTracked(trackedShare);
    const std::uint64_t afterTracked = left();
    const bool complete = listCandidates(shareOf(afterTracked, frontShare));
    // What the uniform sample needs stays; it comes last, because nothing may be found after it was drawn.
    const std::uint64_t spare = shareOf(left(), static_cast<double>(m_settings.auditShare));
    if (!m_scratch.candidates.empty()) {
        walk(spare);
        diveOn(spare);
    }
    audit(complete);
}

}  // namespace grapeshot::detail
