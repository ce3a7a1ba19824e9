#include <grapeshot/scf/detail/track_motion.hpp>

#include <algorithm>
#include <bit>
#include <utility>

namespace grapeshot::detail {
namespace {

std::uint64_t joined(std::uint32_t a, std::uint32_t b) {
    return std::uint64_t{a} << 32U | b;
}

}  // namespace

TrackMotion::TrackMotion(const ImpactSpace& space, const TrackSettings& settings, Meter& meter, TrackerMemory& memory,
                         TrackerScratch& scratch, TrackResult& out)
    : m_space(space),
      m_settings(settings),
      m_meter(meter),
      m_memory(memory),
      m_scratch(scratch),
      m_out(out),
      m_key{settings.seed, settings.pair, memory.step} {
    scratch.contacts.clear();
    scratch.nearPairs.clear();
    scratch.kept.clear();
    // When a contact that goes on was found.
    for (std::uint32_t i = 0; i < memory.tracked.size() && settings.mode != TrackMode::exact; ++i) {
        scratch.nearPairs.insert(keyOf(memory.tracked[i].pair), i);
    }
    out.carried = settings.mode == TrackMode::exact ? 0 : static_cast<std::uint32_t>(memory.tracked.size());
}

bool TrackMotion::hasMoreThan(std::uint64_t spare) {
    const std::uint64_t left = m_meter.left(m_work);
    return left == unlimited || left > spare;
}

LanePair TrackMotion::lanesOf(const TrianglePair& pair) const {
    const auto lane = [](const BallTree& tree, std::uint32_t triangle) {
        const std::uint32_t leaf = tree.leafOfTriangle[triangle];
        const std::uint32_t* const all = tree.leaves[leaf].triangle;
        return leaf << 4U | static_cast<std::uint32_t>(std::find(all, all + 16, triangle) - all);
    };
    return {lane(m_space.a->tree(), pair.triangleA), lane(m_space.b->tree(), pair.triangleB)};
}

std::uint64_t TrackMotion::keyOf(TrianglePair pair) const {
    if (m_settings.mode != TrackMode::exact) {
        const Cells& cellsB = m_space.isSelf() ? m_scratch.spacingA : m_scratch.spacingB;
        pair = {m_scratch.spacingA.idOf(m_space.a->tree(), pair.triangleA),
                cellsB.idOf(m_space.b->tree(), pair.triangleB)};
    }
    if (m_space.isSelf() && pair.triangleA > pair.triangleB) {
        std::swap(pair.triangleA, pair.triangleB);
    }
    return joined(pair.triangleA, pair.triangleB);
}

bool TrackMotion::isSettled(const WaitingPair& pieces) const {
    if (m_settings.mode == TrackMode::exact) {
        return false;
    }
    const Cells& cellsA = m_scratch.spacingA;
    const Cells& cellsB = m_space.isSelf() ? m_scratch.spacingA : m_scratch.spacingB;
    std::uint32_t a = cellsA.cellAt(pieces.a);
    std::uint32_t b = cellsB.cellAt(pieces.b);
    // Of a leaf that is larger than a cell every triangle counts.
    if (a == noCell || b == noCell || (isBallLeaf(pieces.a) && cellsA.coarse[ballIndex(pieces.a)] != 0) ||
        (isBallLeaf(pieces.b) && cellsB.coarse[ballIndex(pieces.b)] != 0)) {
        return false;
    }
    if (m_space.isSelf() && a > b) {
        std::swap(a, b);
    }
    const std::uint32_t* const known = m_scratch.contacts.find(joined(a, b));
    return known != nullptr && *known < m_known;
}

void TrackMotion::accept(int lane, float time) {
    const ImpactBatch& batch = m_scratch.impact.batch;
    const Impact impact = batch.impactOf(m_space, lane, std::min(time, 1.0F));
    const std::uint64_t key = keyOf(impact.pair);
    const auto index = static_cast<std::uint32_t>(m_out.contacts.size());
    const auto entry = m_scratch.contacts.insert(key, index);
    m_isNew = m_isNew || entry.value >= m_known;
    if (!entry.isNew) {
        return;
    }
    TrackedContact contact;
    contact.pair = impact.pair;
    contact.onA = impact.onA;
    contact.onB = impact.onB;
    contact.normal = impact.normal;
    contact.featureA = impact.featureA;
    contact.featureB = impact.featureB;
    contact.signedDistance = batch.out().signedDistance[lane];
    contact.overlapping = (batch.out().overlapping >> static_cast<unsigned>(lane) & 1U) != 0U;
    contact.time =
        std::min(1.0F, (static_cast<float>(m_part.index) + std::min(time, 1.0F)) / static_cast<float>(m_part.count));
    if (m_space.isSelf() && contact.pair.triangleA > contact.pair.triangleB) {
        std::swap(contact.pair.triangleA, contact.pair.triangleB);
        std::swap(contact.onA, contact.onB);
        std::swap(contact.featureA, contact.featureB);
        contact.normal = -contact.normal;
    }
    std::uint64_t birth = m_memory.step;
    if (const std::uint32_t* before = m_scratch.nearPairs.find(key)) {
        birth = m_memory.tracked[*before].birth;
    }
    contact.age = static_cast<std::uint32_t>(m_memory.step - birth);
    m_out.contacts.push_back(contact);
    m_scratch.kept.push_back({contact.pair, birth});
}

void TrackMotion::advance(ImpactFront& front, const LanePair* pairs, float (&time)[16], int count) {
    ImpactBatch& batch = m_scratch.impact.batch;
    alignas(64) float step[16];
    batch.load(m_space, pairs, count);
    std::uint32_t open = (1U << static_cast<unsigned>(count)) - 1U;
    for (int round = 0; open != 0U && round < impacts::roundsInARow; ++round) {
        ++m_work;
        std::uint32_t touching = batch.run(m_space, time, step) & open;
        for (std::uint32_t left = open; left != 0U; left &= left - 1U) {
            const auto lane = static_cast<unsigned>(std::countr_zero(left));
            if ((touching >> lane & 1U) == 0U && !(step[lane] > impacts::smallestStep)) {
                touching |= 1U << lane;
            }
        }
        open &= ~touching;
        for (; touching != 0U; touching &= touching - 1U) {
            const auto lane = static_cast<unsigned>(std::countr_zero(touching));
            accept(static_cast<int>(lane), time[lane]);
        }
        for (std::uint32_t left = open; left != 0U; left &= left - 1U) {
            const auto lane = static_cast<unsigned>(std::countr_zero(left));
            time[lane] = (time[lane] + std::min(step[lane], 2.0F)) * impacts::timeRounding;
            if (time[lane] >= impacts::afterTheEnd) {
                open &= ~(1U << lane);
            }
        }
    }
    for (; open != 0U; open &= open - 1U) {
        const auto lane = static_cast<unsigned>(std::countr_zero(open));
        put(front.triangles, {time[lane], pairs[lane].a, pairs[lane].b});
    }
}

void TrackMotion::testTracked(double share) {
    const std::vector<TrackedPair>& tracked = m_memory.tracked;
    const std::uint64_t limit = shareOf(m_meter.left(m_work), share);
    const std::uint64_t first = m_work;
    std::size_t next = 0;
    while (next < tracked.size() && hasMoreThan(0) && (limit == unlimited || m_work - first < limit)) {
        LanePair pairs[16];
        alignas(64) float time[16] = {};
        int count = 0;
        for (; next < tracked.size() && count < batchWidth; ++next) {
            if (m_scratch.contacts.find(keyOf(tracked[next].pair)) == nullptr) {
                pairs[count++] = lanesOf(tracked[next].pair);
            }
        }
        if (count > 0) {
            advance(m_scratch.impact.front, pairs, time, count);
        }
    }
    m_out.carried = std::min(m_out.carried, static_cast<std::uint32_t>(tracked.size() - next));
}

void TrackMotion::open(ImpactFront& front) {
    const WaitingPair next = take(front.pieces);
    if (isSettled(next)) {
        return;
    }
    if (isBallLeaf(next.a) && isBallLeaf(next.b)) {
        const std::uint32_t leafA = ballIndex(next.a);
        const std::uint32_t leafB = ballIndex(next.b);
        m_work += m_space.openLeaves(
            leafA, leafB, impacts::afterTheEnd, [&](unsigned laneA, unsigned laneB, float time, float) {
                put(front.triangles, {std::max(time, next.time), leafA << 4U | laneA, leafB << 4U | laneB});
            });
        return;
    }
    ChildPairs children;
    float time[16];
    float overlap[16];
    m_work += m_space.expand({next.a, next.b}, impacts::afterTheEnd, children, time, overlap);
    for (std::uint32_t left = children.mask; left != 0U; left &= left - 1U) {
        const auto lane = static_cast<unsigned>(std::countr_zero(left));
        const BallPair pair = children.at(lane);
        put(front.pieces, {std::max(time[lane], next.time), pair.a, pair.b});
    }
}

void TrackMotion::advanceEarliest(ImpactFront& front) {
    LanePair pairs[16];
    alignas(64) float time[16] = {};
    int count = 0;
    while (count < batchWidth && !front.triangles.empty()) {
        const WaitingPair next = take(front.triangles);
        const TrianglePair pair{m_space.a->tree().leaves[next.a >> 4U].triangle[next.a & 15U],
                                m_space.b->tree().leaves[next.b >> 4U].triangle[next.b & 15U]};
        const std::uint32_t* const known = m_scratch.contacts.find(keyOf(pair));
        if (known == nullptr || *known >= m_known) {
            pairs[count] = {next.a, next.b};
            time[count++] = next.time;
        }
    }
    if (count > 0) {
        advance(front, pairs, time, count);
    }
}

bool TrackMotion::search(ImpactFront& front, std::uint64_t spare) {
    while (front.size() > 0) {
        if (!hasMoreThan(spare)) {
            return false;
        }
        front.isForTriangles() ? advanceEarliest(front) : open(front);
    }
    return true;
}

void TrackMotion::audit() {
    ImpactFront& front = m_scratch.impact.front;
    MissEstimate& miss = m_out.miss;
    miss.candidates = miss.unknown = front.size();
    miss.reported = m_out.contacts.size();
    // How many is decided before the first is searched: to stop when the budget ends would prefer the cheap ones.
    const std::uint64_t units = m_meter.left(m_work);
    const auto population = static_cast<double>(miss.unknown);
    const double affordable =
        units == unlimited ? population : impacts::caution * static_cast<double>(units) / impacts::priceOfASample;
    miss.sampled = m_settings.auditShare > 0 ? static_cast<std::uint64_t>(std::min(affordable, population)) : 0;
    m_known = m_out.contacts.size();
    ImpactFront unfinished;
    const auto drawn = [&](std::vector<WaitingPair>& heap, std::size_t i) {
        const WaitingPair one = heap[i];
        heap[i] = heap.back();
        heap.pop_back();
        return one;
    };
    for (std::uint64_t i = 0; i < miss.sampled; ++i) {
        const std::uint64_t place = randomBits(m_key, m_draw++) % front.size();
        ImpactFront& side = m_scratch.impact.side;
        side.clear();
        if (place < front.pieces.size()) {
            side.pieces.push_back(drawn(front.pieces, place));
        } else {
            side.triangles.push_back(drawn(front.triangles, place - front.pieces.size()));
        }
        m_isNew = false;
        const bool isFinished = search(side, 0);
        miss.hits += m_isNew ? 1 : 0;
        miss.open += !isFinished && !m_isNew ? 1 : 0;
        unfinished.pieces.insert(unfinished.pieces.end(), side.pieces.begin(), side.pieces.end());
        unfinished.triangles.insert(unfinished.triangles.end(), side.triangles.begin(), side.triangles.end());
    }
    front.pieces.insert(front.pieces.end(), unfinished.pieces.begin(), unfinished.pieces.end());
    front.triangles.insert(front.triangles.end(), unfinished.triangles.begin(), unfinished.triangles.end());
    estimateMissed(miss, true, static_cast<double>(randomUnit(m_key, m_draw++)));
}

bool TrackMotion::run(const StepPart& part) {
    m_part = part;
    m_known = static_cast<std::size_t>(-1);  // whatever is found is known
    ImpactFront& front = m_scratch.impact.front;
    front.clear();
    if (m_settings.mode != TrackMode::exact) {
        testTracked(m_settings.mode == TrackMode::budget ? trackedShare : 1);
    }
    put(front.pieces, {0, 0, 0});
    const bool isSampled = m_settings.mode == TrackMode::budget && part.index + 1 == part.count;
    const std::uint64_t left = m_meter.left(m_work);
    const std::uint64_t spare =
        isSampled && left != unlimited ? shareOf(left, static_cast<double>(m_settings.auditShare)) : 0;
    m_isComplete = search(front, spare);
    if (isSampled) {
        audit();
        m_isComplete = front.size() == 0;
    }
    return m_isComplete;
}

void TrackMotion::finish() {
    std::vector<TrackedPair>& tracked = m_memory.tracked;
    tracked.erase(tracked.begin(), tracked.end() - static_cast<std::ptrdiff_t>(m_out.carried));
    std::erase_if(tracked, [&](const TrackedPair& one) { return m_scratch.contacts.find(keyOf(one.pair)) != nullptr; });
    m_out.carried = static_cast<std::uint32_t>(tracked.size());
    if (m_settings.mode != TrackMode::exact) {
        tracked.insert(tracked.end(), m_scratch.kept.begin(), m_scratch.kept.end());
    }
    m_out.tracked = static_cast<std::uint32_t>(tracked.size());
    m_out.certain = m_isComplete;
    m_out.stop = m_out.certain ? StopReason::certain : StopReason::budget;
    ++m_memory.step;
}

}  // namespace grapeshot::detail
