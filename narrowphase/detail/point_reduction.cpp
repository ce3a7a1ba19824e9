#include <grapeshot/narrowphase/detail/point_reduction.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace grapeshot::detail {
namespace {

// As parts of mergeDistance.
constexpr float clearlyDeeper = 0.1F;  // a new point replaces what is there for its depth
constexpr float touchingIfNew = 0.1F;  // gap to the supporting plane up to which a point carries
constexpr float touchingIfKept = 0.3F;
// As factors of the spread.
constexpr float gainOfAddition = 1.10F;
constexpr float gainOverKept = 1.15F;
constexpr float gainOverNew = 1.001F;
constexpr float lossOfRedundant = 1.02F;

constexpr int directions = 16;
constexpr int maxMembers = 8;  // while choosing; slots that became one region bring up to that many kept points

/// The chosen points while they change.
struct Members {
    std::array<int, maxMembers + 1> index{};
    int count = 0;

    [[nodiscard]] std::span<const int> all() const { return {index.data(), static_cast<std::size_t>(count)}; }
    void add(int candidate) { index[static_cast<std::size_t>(count++)] = candidate; }
    void remove(int at) {
        std::copy(index.begin() + at + 1, index.begin() + count, index.begin() + at);
        --count;
    }
};

class Reducer {
  public:
    Reducer(std::span<const ReductionCandidate> candidates, float mergeDistance)
        : m_candidates(candidates), m_merge(mergeDistance) {
        m_lowest = std::numeric_limits<float>::max();
        for (const ReductionCandidate& candidate : candidates) {
            m_lowest = std::min(m_lowest, candidate.signedDistance);
        }
        fitTilt();
    }

    Reduction run() {
        // Points that carry come first. What only hangs near by fills the places that are left: a table on a central
        // foot must not trade the foot's corners for legs that end above the floor.
        for (const bool touching : {true, false}) {
            const int firstFree = touching ? 0 : m_members.count;
            if (firstFree < maxPointsPerRegion) {
                addKept(touching, firstFree);
                gatherExtremes(touching);
                if (m_members.count == 0) {
                    addDeepest(touching);
                }
                grow();
                swap(firstFree);
                dropRedundant(firstFree);
            }
        }
        requireDeepest();
        return result();
    }

  private:
    [[nodiscard]] const ReductionCandidate& at(int index) const {
        return m_candidates[static_cast<std::size_t>(index)];
    }
    [[nodiscard]] bool isDeepest(int index) const {
        return at(index).signedDistance <= m_lowest + clearlyDeeper * m_merge;
    }
    [[nodiscard]] float residual(int index) const {
        return at(index).signedDistance - m_tilt[0] * at(index).u - m_tilt[1] * at(index).v;
    }
    [[nodiscard]] bool isTouching(int index) const {
        return residual(index) <= m_lowestResidual + (at(index).kept ? touchingIfKept : touchingIfNew) * m_merge;
    }
    [[nodiscard]] bool isNear(int left, int right) const {
        return (at(left).onA - at(right).onA).squaredNorm() < m_merge * m_merge;
    }
    /// Is the candidate too near to a member, other than the one at `except`?
    [[nodiscard]] bool conflicts(int candidate, int except = -1) const {
        for (int i = 0; i < m_members.count; ++i) {
            if (i != except && isNear(candidate, m_members.index[static_cast<std::size_t>(i)])) {
                return true;
            }
        }
        return false;
    }

    /// A body that rests tilted by little still stands on its whole foot: gaps count above the plane that fits the
    /// signed distances best. Below half of mergeDistance of extent there is no tilt to speak of.
    void fitTilt() {
        double count = 0, meanU = 0, meanV = 0, meanD = 0;
        for (const ReductionCandidate& c : m_candidates) {
            count += 1;
            meanU += static_cast<double>(c.u);
            meanV += static_cast<double>(c.v);
            meanD += static_cast<double>(c.signedDistance);
        }
        meanU /= count, meanV /= count, meanD /= count;
        double uu = 0, uv = 0, vv = 0, ud = 0, vd = 0;
        for (const ReductionCandidate& c : m_candidates) {
            const double u = static_cast<double>(c.u) - meanU;
            const double v = static_cast<double>(c.v) - meanV;
            const double d = static_cast<double>(c.signedDistance) - meanD;
            uu += u * u, uv += u * v, vv += v * v, ud += u * d, vd += v * d;
        }
        const double ridge = count * 0.25 * static_cast<double>(m_merge) * static_cast<double>(m_merge);
        uu += ridge, vv += ridge;
        const double determinant = uu * vv - uv * uv;
        if (determinant > 0) {
            m_tilt[0] = static_cast<float>((ud * vv - vd * uv) / determinant);
            m_tilt[1] = static_cast<float>((vd * uu - ud * uv) / determinant);
        }
        m_lowestResidual = std::numeric_limits<float>::max();
        for (int i = 0; i < static_cast<int>(m_candidates.size()); ++i) {
            m_lowestResidual = std::min(m_lowestResidual, residual(i));
        }
    }

    /// Area and perimeter of the hull of up to four points, as one number (Steiner's formula for the widened hull).
    [[nodiscard]] float spread(std::span<const int> members) const {
        const float radius = 0.5F * m_merge;
        const float point = 3.14159265F * radius * radius;
        const int count = static_cast<int>(members.size());
        const auto length = [&](int i, int j) {
            const ReductionCandidate& a = at(members[static_cast<std::size_t>(i)]);
            const ReductionCandidate& b = at(members[static_cast<std::size_t>(j)]);
            return std::hypot(a.u - b.u, a.v - b.v);
        };
        // Cross product of two differences.
        const auto cross = [&](int i, int j, int k, int l) {
            const ReductionCandidate& a = at(members[static_cast<std::size_t>(i)]);
            const ReductionCandidate& b = at(members[static_cast<std::size_t>(j)]);
            const ReductionCandidate& c = at(members[static_cast<std::size_t>(k)]);
            const ReductionCandidate& d = at(members[static_cast<std::size_t>(l)]);
            return std::abs((b.u - a.u) * (d.v - c.v) - (b.v - a.v) * (d.u - c.u));
        };
        if (count <= 1) {
            return point;
        }
        if (count == 2) {
            return point + radius * 2.0F * length(0, 1);
        }
        if (count == 3) {
            return point + 0.5F * cross(0, 1, 0, 2) + radius * (length(0, 1) + length(1, 2) + length(2, 0));
        }
        // The hull of four points is a triangle of them or the quadrangle whose diagonals span the largest area.
        float area = 0, perimeter = 0;
        constexpr int triangles[4][3] = {{0, 1, 2}, {0, 1, 3}, {0, 2, 3}, {1, 2, 3}};
        for (const auto& [i, j, k] : triangles) {
            const float a = cross(i, j, i, k);
            const float p = length(i, j) + length(j, k) + length(k, i);
            if (a > area || (a == area && p > perimeter)) {
                area = a, perimeter = p;
            }
        }
        constexpr int quadrangles[3][4] = {{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 3, 1, 2}};  // two diagonals each
        for (const auto& [i, j, k, l] : quadrangles) {
            const float a = cross(i, j, k, l);
            if (a > area) {
                area = a, perimeter = length(i, k) + length(k, j) + length(j, l) + length(l, i);
            }
        }
        return point + 0.5F * area + radius * perimeter;
    }
    /// ... of the members with one replaced (`at`), or one more (`at` = count), or one less (`candidate` = -1).
    [[nodiscard]] float spreadWith(int at, int candidate) const {
        Members changed = m_members;
        if (candidate < 0) {
            changed.remove(at);
        } else if (at == changed.count) {
            changed.add(candidate);
        } else {
            changed.index[static_cast<std::size_t>(at)] = candidate;
        }
        return spread(changed.all());
    }
    [[nodiscard]] bool deepestIsAmong(int except) const {
        for (int i = 0; i < m_members.count; ++i) {
            if (i != except && isDeepest(m_members.index[static_cast<std::size_t>(i)])) {
                return true;
            }
        }
        return false;
    }

    void addKept(bool touching, int firstFree) {
        for (int i = 0; i < static_cast<int>(m_candidates.size()) && m_members.count < maxMembers; ++i) {
            if (at(i).kept && isTouching(i) == touching && !conflicts(i)) {
                m_members.add(i);
            }
        }
        while (m_members.count > maxPointsPerRegion) {
            removeLeast(firstFree);
        }
    }
    /// Takes out the member whose loss is smallest.
    void removeLeast(int firstFree) {
        int worst = m_members.count - 1;
        float best = -1;
        for (int i = firstFree; i < m_members.count; ++i) {
            if (isDeepest(m_members.index[static_cast<std::size_t>(i)]) && !deepestIsAmong(i)) {
                continue;
            }
            const float rest = spreadOfMany(i);
            if (rest > best) {
                best = rest, worst = i;
            }
        }
        m_members.remove(worst);
    }
    /// Sum of the squared distances stands in for the spread where there are more than four points left.
    [[nodiscard]] float spreadOfMany(int without) const {
        if (m_members.count - 1 <= maxPointsPerRegion) {
            return spreadWith(without, -1);
        }
        float sum = 0;
        for (int i = 0; i < m_members.count; ++i) {
            for (int j = i + 1; j < m_members.count; ++j) {
                if (i != without && j != without) {
                    const ReductionCandidate& a = at(m_members.index[static_cast<std::size_t>(i)]);
                    const ReductionCandidate& b = at(m_members.index[static_cast<std::size_t>(j)]);
                    sum += std::hypot(a.u - b.u, a.v - b.v);
                }
            }
        }
        return sum;
    }
    void addDeepest(bool touching) {
        int best = -1;
        for (int i = 0; i < static_cast<int>(m_candidates.size()); ++i) {
            if (isTouching(i) == touching && (best < 0 || at(i).signedDistance < at(best).signedDistance)) {
                best = i;
            }
        }
        if (best >= 0) {
            m_members.add(best);
        }
    }

    /// The outermost new candidates in 16 directions: enough for every corner of a foot that matters.
    void gatherExtremes(bool touching) {
        std::array<float, directions> reach;
        std::array<int, directions> outermost;
        reach.fill(-std::numeric_limits<float>::max());
        outermost.fill(-1);
        struct Table {
            std::array<float, directions> cosine, sine;
            Table() {
                for (int k = 0; k < directions; ++k) {
                    // Turned off the axes, where the edges of boxes would give ties.
                    const double angle = 6.283185307179586 * (k + 0.31) / directions;
                    cosine[static_cast<std::size_t>(k)] = static_cast<float>(std::cos(angle));
                    sine[static_cast<std::size_t>(k)] = static_cast<float>(std::sin(angle));
                }
            }
        };
        static const Table table;
        for (int i = 0; i < static_cast<int>(m_candidates.size()); ++i) {
            if (isTouching(i) != touching) {
                continue;
            }
            for (std::size_t k = 0; k < directions; ++k) {
                const float along = table.cosine[k] * at(i).u + table.sine[k] * at(i).v;
                if (along > reach[k]) {
                    reach[k] = along, outermost[k] = i;
                }
            }
        }
        m_extremeCount = 0;
        for (const int i : outermost) {
            const auto end = m_extremes.begin() + m_extremeCount;
            if (i >= 0 && std::find(m_extremes.begin(), end, i) == end) {
                m_extremes[static_cast<std::size_t>(m_extremeCount++)] = i;
            }
        }
    }
    [[nodiscard]] std::span<const int> extremes() const {
        return {m_extremes.data(), static_cast<std::size_t>(m_extremeCount)};
    }

    void grow() {
        while (m_members.count > 0 && m_members.count < maxPointsPerRegion) {
            int best = -1;
            float bestSpread = gainOfAddition * spread(m_members.all());
            for (const int candidate : extremes()) {
                if (conflicts(candidate)) {
                    continue;
                }
                if (const float wider = spreadWith(m_members.count, candidate); wider > bestSpread) {
                    bestSpread = wider, best = candidate;
                }
            }
            if (best < 0) {
                return;
            }
            m_members.add(best);
        }
    }

    void swap(int firstFree) {
        // Each swap widens by a factor, so this ends; the limit keeps the cost bounded.
        for (int round = 0; round < 12; ++round) {
            const float now = spread(m_members.all());
            int bestAt = -1, bestCandidate = -1;
            float bestSpread = now;
            for (int i = firstFree; i < m_members.count; ++i) {
                const int member = m_members.index[static_cast<std::size_t>(i)];
                const float needed = now * (at(member).kept ? gainOverKept : gainOverNew);
                const bool onlyDeepest = isDeepest(member) && !deepestIsAmong(i);
                for (const int candidate : extremes()) {
                    if (conflicts(candidate, i) || (onlyDeepest && !isDeepest(candidate))) {
                        continue;
                    }
                    const float wider = spreadWith(i, candidate);
                    if (wider > needed && wider > bestSpread) {
                        bestSpread = wider, bestAt = i, bestCandidate = candidate;
                    }
                }
            }
            if (bestAt < 0) {
                return;
            }
            m_members.index[static_cast<std::size_t>(bestAt)] = bestCandidate;
        }
    }

    void requireDeepest() {
        if (deepestIsAmong(-1)) {
            return;
        }
        int deepest = 0;
        for (int i = 1; i < static_cast<int>(m_candidates.size()); ++i) {
            if (at(i).signedDistance < at(deepest).signedDistance) {
                deepest = i;
            }
        }
        for (int i = m_members.count; i-- > 0;) {
            if (isNear(deepest, m_members.index[static_cast<std::size_t>(i)])) {
                m_members.remove(i);
            }
        }
        if (m_members.count < maxPointsPerRegion) {
            m_members.add(deepest);
            return;
        }
        int worst = 0;
        float best = -1;
        for (int i = 0; i < m_members.count; ++i) {
            if (const float rest = spreadWith(i, deepest); rest > best) {
                best = rest, worst = i;
            }
        }
        m_members.index[static_cast<std::size_t>(worst)] = deepest;
    }

    void dropRedundant(int firstFree) {
        for (int i = m_members.count; i-- > firstFree;) {
            const bool onlyDeepest = isDeepest(m_members.index[static_cast<std::size_t>(i)]) && !deepestIsAmong(i);
            if (m_members.count > 1 && !onlyDeepest && spread(m_members.all()) < lossOfRedundant * spreadWith(i, -1)) {
                m_members.remove(i);
            }
        }
    }

    [[nodiscard]] Reduction result() const {
        Reduction reduction;
        std::array<int, maxMembers + 1> sorted = m_members.index;
        std::sort(sorted.begin(), sorted.begin() + m_members.count,
                  [&](int left, int right) { return at(left).kept != at(right).kept ? at(left).kept : left < right; });
        reduction.count = m_members.count;
        std::copy_n(sorted.begin(), m_members.count, reduction.chosen.begin());
        return reduction;
    }

    std::span<const ReductionCandidate> m_candidates;
    float m_merge;
    float m_lowest = 0;
    float m_lowestResidual = 0;
    std::array<float, 2> m_tilt{};
    Members m_members;
    std::array<int, directions> m_extremes{};
    int m_extremeCount = 0;
};

}  // namespace

Reduction reducePoints(std::span<const ReductionCandidate> candidates, float mergeDistance) {
    return candidates.empty() ? Reduction{} : Reducer(candidates, mergeDistance).run();
}

}  // namespace grapeshot::detail
