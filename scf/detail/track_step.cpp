#include <grapeshot/scf/detail/track_step.hpp>

namespace grapeshot::detail {
namespace {

constexpr double frontShare = 0.5;  // of what is left then

TrackedContact contactOf(const PairBatch& batch, int lane) {
    TrackedContact contact;
    batch.describe(lane, contact);
    return contact;
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

}  // namespace grapeshot::detail
