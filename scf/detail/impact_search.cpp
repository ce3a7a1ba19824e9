#include <grapeshot/scf/detail/impact_search.hpp>

#include <algorithm>

namespace grapeshot::detail {
namespace {

struct LessPromising {
    bool operator()(const WaitingPair& x, const WaitingPair& y) const {
        return x.promise != y.promise ? x.promise < y.promise : x < y;
    }
};

/// Also of what is not finite.
float promiseOf(float overlap, int leaves) {
    return (overlap > 0 ? overlap : 0) + impacts::promiseOfALeaf * static_cast<float>(leaves);
}

/// Do they move against each other by more than half of the smaller one's radius? If they hardly move, much is near
/// from the start, and overlaps say little.
bool goesFar(const ImpactSpace& space) {
    if (space.isSelf()) {
        return false;
    }
    SweptBalls roots{};
    space.a->putBall(0, roots, 0);
    space.b->putBall(0, roots, 1);
    float square = 0;
    for (const auto& path : roots.path) {
        square += (path[0] - path[1]) * (path[0] - path[1]);
    }
    const float radius = std::min(roots.radius[0], roots.radius[1]);
    return square > 0.25F * radius * radius;
}

}  // namespace

ImpactSearch::ImpactSearch(const ImpactSpace& space, Meter& meter, const RandomKey& key, std::uint32_t firstDraw,
                           std::uint64_t spent, ImpactScratch& scratch)
    : m_space(space),
      m_meter(meter),
      m_scratch(scratch),
      m_key(key),
      m_draw(firstDraw),
      m_begin(spent),
      m_work(spent),
      m_isHasty(meter.left(spent) != unlimited && goesFar(space)),
      m_limit(impacts::afterTheEnd) {
    scratch.front.clear();
    scratch.side.clear();
    scratch.front.pieces.push_back({0, 0, 0});
}

bool ImpactSearch::hasMoreThan(std::uint64_t spare) {
    const std::uint64_t left = m_meter.left(m_work);
    return left == unlimited || left > spare;
}

float ImpactSearch::freeUntil() const {
    float earliest = std::min(m_limit, 1.0F);
    for (const std::vector<WaitingPair>* heap : {&m_scratch.front.pieces, &m_scratch.front.triangles}) {
        earliest = heap->empty() ? earliest : std::min(earliest, heap->front().time);
    }
    return earliest;
}

void ImpactSearch::dropLate(ImpactFront& front) const {
    if (front.isByPromise) {
        return;  // nothing is late before an impact is known
    }
    for (std::vector<WaitingPair>* heap : {&front.pieces, &front.triangles}) {
        if (!heap->empty() && heap->front().time >= m_limit) {
            heap->clear();
        }
    }
}

void ImpactFront::order(bool byPromise) {
    if (byPromise == isByPromise) {
        return;
    }
    isByPromise = byPromise;
    for (std::vector<WaitingPair>* heap : {&pieces, &triangles}) {
        byPromise ? std::make_heap(heap->begin(), heap->end(), LessPromising{})
                  : std::make_heap(heap->begin(), heap->end());
    }
}

void ImpactFront::putInOrder(std::vector<WaitingPair>& heap, const WaitingPair& pair) const {
    if (!isByPromise) {
        put(heap, pair);
        return;
    }
    heap.push_back(pair);
    std::push_heap(heap.begin(), heap.end(), LessPromising{});
}

WaitingPair ImpactFront::takeInOrder(std::vector<WaitingPair>& heap) const {
    if (!isByPromise) {
        return take(heap);
    }
    std::pop_heap(heap.begin(), heap.end(), LessPromising{});
    const WaitingPair best = heap.back();
    heap.pop_back();
    return best;
}

bool ImpactFront::isForTriangles() const {
    const std::size_t due = triangles.size();
    if (isByPromise) {
        return pieces.empty() || due >= impacts::worthACall;
    }
    return pieces.empty() || due >= batchWidth ||
           (due >= impacts::worthACall && triangles.front().time < pieces.front().time);
}

bool ImpactSearch::isForPromise() const {
    const std::uint64_t done = m_work - m_begin;
    if (!m_isHasty || m_impact || done >= impacts::promisedUnits) {
        return false;
    }
    std::uint64_t begin = 0;
    std::uint64_t end = impacts::firstPeriod;
    for (; end <= done; end *= 2) {
        begin = end;
    }
    return 4 * (done - begin) < 3 * (end - begin);
}

bool ImpactSearch::run(std::uint64_t spare) {
    ImpactFront& front = m_scratch.front;
    const bool isExhausted = run(front, spare);
    front.order(false);
    return isExhausted;
}

bool ImpactSearch::run(ImpactFront& front, std::uint64_t spare) {
    while (true) {
        front.order(&front == &m_scratch.front && isForPromise());
        dropLate(front);
        if (front.size() == 0) {
            return true;
        }
        if (!hasMoreThan(spare)) {
            return false;
        }
        front.isForTriangles() ? advanceEarliest(front) : open(front);
    }
}

void ImpactSearch::open(ImpactFront& front) {
    const WaitingPair next = front.takeInOrder(front.pieces);
    if (isBallLeaf(next.a) && isBallLeaf(next.b)) {
        openLeaves(front, next);
        return;
    }
    ChildPairs children;
    float time[16];
    float overlap[16];
    m_work += m_space.expand({next.a, next.b}, m_limit, children, time, overlap);
    for (std::uint32_t left = children.mask; left != 0U; left &= left - 1U) {
        const auto lane = static_cast<unsigned>(std::countr_zero(left));
        const BallPair pair = children.at(lane);
        const int leaves = (isBallLeaf(pair.a) ? 1 : 0) + (isBallLeaf(pair.b) ? 1 : 0);
        front.putInOrder(front.pieces,
                         {std::max(time[lane], next.time), pair.a, pair.b, promiseOf(overlap[lane], leaves)});
    }
}

void ImpactSearch::openLeaves(ImpactFront& front, const WaitingPair& leaves) {
    const std::uint32_t leafA = ballIndex(leaves.a);
    const std::uint32_t leafB = ballIndex(leaves.b);
    m_work += m_space.openLeaves(leafA, leafB, m_limit, [&](unsigned laneA, unsigned laneB, float time, float overlap) {
        front.putInOrder(front.triangles, {std::max(time, leaves.time), leafA << 4U | laneA, leafB << 4U | laneB,
                                           promiseOf(overlap, 0)});
    });
}

void ImpactSearch::advanceEarliest(ImpactFront& front) {
    LanePair pairs[16];
    alignas(64) float time[16] = {};
    float step[16];
    float promise[16] = {};
    int count = 0;
    while (count < batchWidth && !front.triangles.empty() &&
           (front.isByPromise || front.triangles.front().time < m_limit)) {
        const WaitingPair next = front.takeInOrder(front.triangles);
        pairs[count] = {next.a, next.b};
        promise[count] = next.promise;
        time[count++] = next.time;
    }
    m_scratch.batch.load(m_space, pairs, count);
    std::uint32_t open = (1U << static_cast<unsigned>(count)) - 1U;
    for (int round = 0; open != 0U && round < impacts::roundsInARow; ++round) {
        ++m_work;
        std::uint32_t touching = m_scratch.batch.run(m_space, time, step) & open;
        for (std::uint32_t left = open & ~touching; left != 0U; left &= left - 1U) {
            const auto lane = static_cast<unsigned>(std::countr_zero(left));
            if (!(step[lane] > impacts::smallestStep)) {
                touching |= 1U << lane;
            }
        }
        for (std::uint32_t left = touching; left != 0U; left &= left - 1U) {
            const auto lane = static_cast<unsigned>(std::countr_zero(left));
            if (time[lane] < m_limit) {
                m_impact = m_scratch.batch.impactOf(m_space, static_cast<int>(lane), std::min(time[lane], 1.0F));
                m_limit = time[lane];
            }
        }
        open &= ~touching;
        for (std::uint32_t left = open; left != 0U; left &= left - 1U) {
            const auto lane = static_cast<unsigned>(std::countr_zero(left));
            time[lane] = (time[lane] + std::min(step[lane], 2.0F)) * impacts::timeRounding;
            if (time[lane] >= m_limit) {
                open &= ~(1U << lane);
            }
        }
    }
    for (; open != 0U; open &= open - 1U) {
        const auto lane = static_cast<unsigned>(std::countr_zero(open));
        if (time[lane] < m_limit) {
            front.putInOrder(front.triangles, {time[lane], pairs[lane].a, pairs[lane].b, promise[lane]});
        }
    }
}

void ImpactSearch::audit(MissEstimate& miss) {
    ImpactFront& front = m_scratch.front;
    dropLate(front);
    // The later ones of both heaps cannot hold an earlier impact.
    for (std::vector<WaitingPair>* heap : {&front.pieces, &front.triangles}) {
        std::erase_if(*heap, [&](const WaitingPair& pair) { return pair.time >= m_limit; });
    }
    miss.candidates = miss.unknown = front.size();
    // How many is decided before the first is searched: to stop when the budget ends would prefer the cheap ones.
    const std::uint64_t units = m_meter.left(m_work);
    const auto population = static_cast<double>(miss.unknown);
    const double affordable =
        units == unlimited ? population : impacts::caution * static_cast<double>(units) / impacts::priceOfASample;
    miss.sampled = static_cast<std::uint64_t>(std::min(affordable, population));
    const float limit = m_limit;
    const auto piecesDone = [&](std::vector<WaitingPair>& heap, std::size_t i) {
        const WaitingPair drawn = heap[i];
        heap[i] = heap.back();
        heap.pop_back();
        return drawn;
    };
    std::vector<WaitingPair> unfinishedPieces;
    std::vector<WaitingPair> unfinishedTriangles;
    for (std::uint64_t i = 0; i < miss.sampled; ++i) {
        const std::uint64_t drawn = randomBits(m_key, m_draw++) % front.size();
        ImpactFront& side = m_scratch.side;
        side.clear();
        if (drawn < front.pieces.size()) {
            side.pieces.push_back(piecesDone(front.pieces, drawn));
        } else {
            side.triangles.push_back(piecesDone(front.triangles, drawn - front.pieces.size()));
        }
        // Each is judged by what was known before the sample.
        const std::optional<Impact> known = m_impact;
        const float knownLimit = m_limit;
        m_limit = limit;
        m_impact.reset();
        const bool finished = run(side, 0);
        miss.hits += m_impact ? 1 : 0;
        miss.open += !finished && !m_impact ? 1 : 0;
        if (!m_impact || knownLimit < m_limit) {
            m_impact = known;
            m_limit = knownLimit;
        }
        unfinishedPieces.insert(unfinishedPieces.end(), side.pieces.begin(), side.pieces.end());
        unfinishedTriangles.insert(unfinishedTriangles.end(), side.triangles.begin(), side.triangles.end());
    }
    front.pieces.insert(front.pieces.end(), unfinishedPieces.begin(), unfinishedPieces.end());
    front.triangles.insert(front.triangles.end(), unfinishedTriangles.begin(), unfinishedTriangles.end());
    std::make_heap(front.pieces.begin(), front.pieces.end());
    std::make_heap(front.triangles.begin(), front.triangles.end());
    dropLate(front);
    estimateMissed(miss, true, static_cast<double>(randomUnit(m_key, m_draw++)));
}

}  // namespace grapeshot::detail
