#include <grapeshot/plugin/detail/frame_work.hpp>

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

#include <grapeshot/narrowphase/schedule.hpp>
#include <grapeshot/narrowphase/worker_threads.hpp>
#include <grapeshot/plugin/detail/shape_models.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

constexpr int mostRounds = 4;

/// A search that is cut short again and again while the bodies move finds little. So what the mandatory slices leave
/// goes to few pairs rather than to all: by the fourth power, the largest becoming what a schedule takes for the most.
void sharpen(std::vector<float>& importance) {
    const float most = importance.empty() ? 1 : *std::ranges::max_element(importance);
    for (float& value : importance) {
        const float part = value / most;
        value = 1e6F * (part * part) * (part * part);
    }
}

class FrameWork {
  public:
    FrameWork(std::span<PairProcessor* const> pairs, std::span<const std::shared_ptr<ShapeEntry>> building,
              Frame& frame, const Settings& settings)
        : m_building(building), m_frame(frame), m_settings(settings) {
        std::vector<std::pair<std::uint64_t, PairProcessor*>> keyed;
        std::ranges::transform(pairs, std::back_inserter(keyed),
                               [](PairProcessor* pair) { return std::pair(pair->key(), pair); });
        // Sums of importance must not depend on the order of the pair cache.
        std::ranges::stable_sort(keyed, {}, &std::pair<std::uint64_t, PairProcessor*>::first);
        std::ranges::transform(keyed, std::back_inserter(m_pairs), &std::pair<std::uint64_t, PairProcessor*>::second);
    }

    void run() {
        if (m_frame.isLimited()) {
            runInSlices();
        } else {
            compute(m_pairs, std::vector<std::uint64_t>(m_pairs.size(), m_settings.pairBudget.work), false);
        }
        std::uint64_t work = 0;
        std::uint64_t mandatory = 0;
        for (PairProcessor* pair : m_pairs) {
            pair->settle();
            work += pair->share().result.work;
            mandatory += pair->share().mandatory;
        }
        m_frame.payDispatch(work, mandatory);
        goOnBuilding();
    }

  private:
    void runInSlices() {
        describe();
        const std::uint64_t share = shareOfPairs();
        std::vector<PairProcessor*> open = m_pairs;
        for (int round = 0; round < mostRounds && !open.empty(); ++round) {
            const std::uint64_t left = share == unlimited ? unlimited : share - std::min(share, spent());
            if (round > 0 && (left == 0 || m_frame.timeLeft() <= std::chrono::nanoseconds(0))) {
                break;
            }
            std::vector<std::uint64_t> slices(open.size());
            if (left == unlimited || (round == 0 && m_frame.budget().time != never)) {
                // With a limit of time everybody begins with the mandatory slice.
                for (std::size_t i = 0; i < open.size(); ++i) {
                    slices[i] = round == 0 ? m_scheduled[i].mandatory : unlimited;
                }
            } else {
                schedule(m_scheduled, left, slices);
            }
            limitByPair(open, slices);
            compute(open, slices, round > 0);
            keepOpen(open);
        }
    }

    [[nodiscard]] std::uint64_t shareOfPairs() const {
        const std::uint64_t share = m_frame.dispatchShare();
        if (m_building.empty() || share == unlimited) {
            return share;
        }
        return share - std::min(share, std::max(buildingSlice, share / 4));
    }

    /// Trees: the mandatory slice whatever that takes, then what the pairs have left.
    void goOnBuilding() {
        if (m_building.empty() || !m_frame.isLimited()) {
            return;
        }
        std::uint64_t work = 0;
        const auto goOn = [&](const Budget& budget) {
            Budget rest = budget;
            for (const auto& entry : m_building) {
                if (rest.time != never) {
                    rest.time = std::min(rest.time, m_frame.timeLeft());
                }
                const std::uint64_t done = entry->goOnBuilding(rest);
                work += done;
                rest.work -= rest.work == unlimited ? 0 : std::min(rest.work, done);
            }
        };
        goOn({.work = buildingSlice});
        m_frame.payBuilding(work, work);
        work = 0;
        Budget rest = m_frame.budget();
        const std::uint64_t share = m_frame.dispatchShare();
        rest.work = share;
        rest.time = m_frame.timeLeft();
        goOn(rest);
        m_frame.payBuilding(work, 0);
    }

    void describe() {
        std::vector<PairTraits> traits;
        for (const PairProcessor* pair : m_pairs) {
            traits.push_back(pair->traits());
        }
        std::vector<float> importance(traits.size());
        importanceOf(traits, importance);
        for (std::size_t i = 0; i < m_pairs.size(); ++i) {
            importance[i] *= static_cast<float>(1 + std::min<std::uint32_t>(m_pairs[i]->age(), 1000));
        }
        sharpen(importance);
        for (std::size_t i = 0; i < m_pairs.size(); ++i) {
            const PairProcessor& pair = *m_pairs[i];
            m_scheduled.push_back({pair.key(), importance[i], 0, pair.mandatory(), pair.wanted()});
        }
    }

    [[nodiscard]] std::uint64_t spent() const {
        std::uint64_t sum = 0;
        for (const PairProcessor* pair : m_pairs) {
            sum += pair->share().result.work;
        }
        return sum;
    }

    void limitByPair(const std::vector<PairProcessor*>& open, std::vector<std::uint64_t>& slices) const {
        for (std::size_t i = 0; i < open.size(); ++i) {
            const std::uint64_t most = m_settings.pairBudget.work;
            slices[i] = std::min(slices[i], most - std::min(most, open[i]->share().result.work));
        }
    }

    /// Leaves those that were cut short and may go on.
    void keepOpen(std::vector<PairProcessor*>& open) {
        std::vector<PairProcessor*> next;
        std::vector<ScheduledPair> scheduled;
        for (std::size_t i = 0; i < open.size(); ++i) {
            if (open[i]->wasCutShort() && open[i]->share().result.work < m_settings.pairBudget.work) {
                next.push_back(open[i]);
                scheduled.push_back(m_scheduled[i]);
                scheduled.back().mandatory = 0;
                scheduled.back().wanted = unlimited;
            }
        }
        open.swap(next);
        m_scheduled.swap(scheduled);
    }

    /// A pair's time: in the first round none but its own limit, so that each gets its mandatory slice done; then in
    /// proportion to its importance.
    void compute(const std::vector<PairProcessor*>& pairs, const std::vector<std::uint64_t>& slices, bool timed) {
        timed = timed && m_frame.budget().time != never;
        double weight = 0;
        for (const ScheduledPair& pair : m_scheduled) {
            weight += timed ? weightOf(pair) : 0.0;
        }
        const auto all = static_cast<double>(m_frame.timeLeft().count()) * m_settings.threads;
        const auto one = [&](std::size_t i) {
            Budget budget = m_settings.pairBudget;
            budget.work = slices[i];
            if (timed) {
                const double part = weightOf(m_scheduled[i]) / weight;
                const auto mine = std::chrono::nanoseconds(static_cast<std::int64_t>(all * part));
                budget.time = std::min({budget.time, mine, m_frame.timeLeft()});
                budget.clock = m_frame.budget().clock;
            }
            pairs[i]->compute(budget);
        };
        std::vector<std::size_t> anywhere;
        for (std::size_t i = 0; i < pairs.size(); ++i) {
            if (pairs[i]->needsBullet()) {
                one(i);
            } else {
                anywhere.push_back(i);
            }
        }
        forEach(anywhere.size(), m_settings.threads, [&](std::size_t i) { one(anywhere[i]); });
    }

    std::span<const std::shared_ptr<ShapeEntry>> m_building;
    Frame& m_frame;
    const Settings& m_settings;
    std::vector<PairProcessor*> m_pairs;
    std::vector<ScheduledPair> m_scheduled;  // of those that are open
};

}  // namespace

void computeFrame(std::span<PairProcessor* const> pairs, std::span<const std::shared_ptr<ShapeEntry>> building,
                  Frame& frame, const Settings& settings) {
    FrameWork(pairs, building, frame, settings).run();
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
