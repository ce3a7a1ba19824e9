#include "tracking_bullet.hpp"

#include <algorithm>
#include <array>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <grapeshot/scf/tracker.hpp>
#include <report/machine.hpp>

#include "bullet_soft_pair.hpp"
#include "tracking_scenes.hpp"

namespace grapeshot::bench {

namespace {

struct BulletSpec {
    const char* name;
    int frequency;
    int frames;
    TrackingBudget budget;
    BulletSoftPair::Trees trees;
};

/// Of one way: each frame's least time, each repetition's sum, and what was found.
struct WayTimes {
    const char* name;
    std::vector<double> us;
    std::vector<double> sums;
    double contacts = 0;

    void add(std::size_t frame, double value, std::size_t found) {
        if (us.size() <= frame) {
            us.push_back(value);
        }
        us[frame] = std::min(us[frame], value);
        sums.back() += value;
        contacts += static_cast<double>(found);
    }
};

constexpr int bulletWarmUp = 2;  // frames: nothing is tracked before the first

class BulletRun {
  public:
    BulletRun(const BulletSpec& spec, std::uint64_t seed)
        : m_spec(spec),
          m_scene(twoBodies(spec.name, spec.frequency, static_cast<std::uint32_t>(seed % 100'003))),
          m_a(buildBallTree(m_scene.a.view())),
          m_b(buildBallTree(m_scene.b.view())),
          m_settings(settingsOf(m_scene, spec.budget, seed)),
          m_pair(m_scene.a, m_scene.b, m_scene.maxDistance, spec.trees) {}

    void runOnce() {
        for (WayTimes* way : {&m_whole, &m_update}) {
            way->sums.push_back(0);
        }
        std::vector<Tracker> trackers(m_ours.size(), Tracker(m_a, m_b));
        for (Ours& one : m_ours) {
            one.times.sums.push_back(0);
        }
        TrackResult result;
        for (int frame = 0; frame < m_spec.frames + bulletWarmUp; ++frame) {
            const TrackingFrame where = twoBodiesAt(m_scene, 0.08F, frame, m_spec.frames + bulletWarmUp);
            // What a solver would know, with a little to spare.
            const std::array given{Stretch::given(1.02F * measureStretch(m_a.surface, where.a)),
                                   Stretch::given(1.02F * measureStretch(m_b.surface, where.b))};
            m_pair.place(where.a, where.b);
            const bool counted = frame >= bulletWarmUp;
            const auto index = static_cast<std::size_t>(frame - bulletWarmUp);
            const double begin = report::threadCpuUs();
            m_pair.updateTrees();
            const double middle = report::threadCpuUs();
            const std::size_t found = m_pair.collide();
            const double end = report::threadCpuUs();
            if (counted) {
                m_whole.add(index, end - begin, found);
                m_update.add(index, middle - begin, 0);
            }
            for (std::size_t i = 0; i < m_ours.size(); ++i) {
                const Ours& one = m_ours[i];
                TrackSettings settings = m_settings;
                settings.mode = one.mode;
                const Stretch stretchA = one.measured ? Stretch::measured() : given[0];
                const Stretch stretchB = one.measured ? Stretch::measured() : given[1];
                const double from = report::threadCpuUs();
                trackers[i].step({where.a, {}, stretchA, {}}, {where.b, {}, stretchB, {}}, settings,
                                 {.work = one.mode == TrackMode::exact ? unlimited : m_spec.budget.work}, result);
                const double us = report::threadCpuUs() - from;
                if (counted) {
                    m_ours[i].times.add(index, us, result.contacts.size());
                }
            }
        }
    }

    void addRows(report::Report& results) const {
        add(m_whole, results);
        add(m_update, results);
        for (const Ours& one : m_ours) {
            add(one.times, results);
        }
    }

  private:
    struct Ours {
        TrackMode mode;
        bool measured;
        WayTimes times;
    };

    void add(const WayTimes& way, report::Report& results) const {
        std::vector<double> ratios;
        for (std::size_t i = 0; i < way.sums.size(); ++i) {
            ratios.push_back(m_whole.sums[i] / way.sums[i]);
        }
        report::Row row;
        row.scenario = "bullet";
        row.mesh = m_spec.name;
        row.triangles = m_scene.a.triangles.size() + m_scene.b.triangles.size();
        row.method = way.name;
        row.peer = m_whole.name;
        row.n = way.us.size();
        row.timeUs = report::quantiles(way.us);
        row.ratio = report::median(ratios);
        row.measured = {{"ratioLeast", *std::ranges::min_element(ratios)},
                        {"ratioMost", *std::ranges::max_element(ratios)},
                        {"contacts", way.contacts / static_cast<double>(way.us.size() * way.sums.size())}};
        results.rows.push_back(row);
    }

    const BulletSpec& m_spec;
    TrackingScene m_scene;
    BallTree m_a, m_b;
    TrackSettings m_settings;
    BulletSoftPair m_pair;
    WayTimes m_whole{
        m_spec.trees == BulletSoftPair::Trees::byBullet ? "Bullet soft-soft, trees by Bullet" : "Bullet soft-soft",
        {},
        {}};
    WayTimes m_update{"Bullet soft-soft, update of the trees alone", {}, {}};
    std::array<Ours, 4> m_ours{Ours{TrackMode::exact, false, {"exact, bound given", {}, {}}},
                               Ours{TrackMode::exact, true, {"exact, bound measured", {}, {}}},
                               Ours{TrackMode::budget, false, {"budget, bound given", {}, {}}},
                               Ours{TrackMode::budget, true, {"budget, bound measured", {}, {}}}};
};

}  // namespace

void addBulletRows(const Options& options, report::Report& results) {
    using enum BulletSoftPair::Trees;
    const TrackingBudget small = withWork(bodiesBudget, 2'000);
    const std::vector<BulletSpec> specs =
        options.quick ? std::vector<BulletSpec>{{"2x1k", 7, 8, small, byBullet}, {"2x1k", 7, 8, small, quickly}}
                      : std::vector<BulletSpec>{{"2x10k", 22, 60, small, byBullet},
                                                {"2x10k", 22, 60, small, quickly},
                                                {"2x100k", 70, 60, bodiesBudget, quickly},
                                                {"2x1M", 224, 16, largeBodiesBudget, quickly}};
    for (const BulletSpec& spec : specs) {
        std::cerr << "bullet, " << spec.name << " ...\n";
        BulletRun run(spec, options.seed);
        for (int repetition = 0; repetition < options.repetitions.value_or(options.quick ? 1 : 5); ++repetition) {
            run.runOnce();
        }
        run.addRows(results);
    }
}

}  // namespace grapeshot::bench
