#include "guarantee_audit.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <deque>
#include <numbers>

#include <grapeshot/adb/audit.hpp>
#include <grapeshot/adb/certificate.hpp>
#include <grapeshot/core/rate_bound.hpp>
#include <support/poses.hpp>

namespace grapeshot::bench {

namespace {

constexpr std::uint32_t pairs = 20;  ///< of a scene
constexpr int shownMeshes = 4;       ///< the first so many
constexpr double size = 2;           ///< diagonal of every mesh's box, m

/// One pair's way: where it touches, and how it moves about that.
class Path {
  public:
    Path(Motion motion, const Pose& touching, std::uint64_t seed)
        : m_motion(motion),
          m_random(seed),
          m_touching(touching),
          m_outwards(touching.translation.normalized()),
          m_axis(m_random.direction()),
          m_phase(m_random.uniform(0, 2 * std::numbers::pi)) {}

    Pose next() {
        Eigen::Vector3f shift;
        Eigen::Vector3f turn;  // rad
        if (m_motion == Motion::resting) {
            // Forgets within some twenty frames; 0.1 % of the size, a tenth of a degree.
            m_tremble = 0.95F * m_tremble + 0.3F * noise();
            m_sway = 0.95F * m_sway + 0.3F * noise();
            shift = static_cast<float>(0.001 * size) * m_tremble;
            turn = static_cast<float>(0.1 * std::numbers::pi / 180) * m_sway;
        } else {
            m_phase += 2 * std::numbers::pi / 150;
            shift = static_cast<float>(0.01 * size * std::sin(m_phase)) * m_outwards;
            m_angle += 0.05 * std::numbers::pi / 180;
            turn = static_cast<float>(m_angle) * m_axis;
        }
        const float angle = turn.norm();
        Pose pose = m_touching;
        pose.translation += shift;
        if (angle > 0) {
            pose.rotation = Eigen::AngleAxisf(angle, turn / angle).toRotationMatrix() * pose.rotation;
        }
        return pose;
    }

  private:
    Eigen::Vector3f noise() {
        const auto one = [this] { return static_cast<float>(m_random.uniform(-1, 1)); };
        const float x = one();
        const float y = one();
        return {x, y, one()};
    }

    Motion m_motion;
    test::Random m_random;
    Pose m_touching;
    Eigen::Vector3f m_outwards, m_axis;
    double m_phase;
    double m_angle = 0;
    Eigen::Vector3f m_tremble = Eigen::Vector3f::Zero();
    Eigen::Vector3f m_sway = Eigen::Vector3f::Zero();
};

struct Sums {
    std::size_t runs = 0, held = 0, alarms = 0, answers = 0, estimated = 0, colliding = 0, misses = 0, falseAlarms = 0;
    std::size_t chosen = 0, checked = 0;
    double answerWork = 0, checkWork = 0;
    double missBounds = 0, falseAlarmBounds = 0;  ///< at the end of the run, summed up
};

/// A scene of pairs under an audit, and the truth beside it.
class Scene {
  public:
    Scene(Motion motion, const Tree& tree, const DecideSettings& settings, const std::vector<Pose>& touching,
          std::uint64_t seed)
        : m_settings(settings), m_seed(seed), m_truth(tree, tree), m_check(tree, tree) {
        test::Random random(seed);
        for (std::uint32_t pair = 0; pair < pairs; ++pair) {
            m_paths.emplace_back(motion, touching[random.bits() % touching.size()], random.bits());
            m_queries.emplace_back(tree, tree);
        }
    }

    void step() {
        for (std::uint32_t pair = 0; pair < pairs; ++pair) {
            const Pose pose = m_paths[pair].next();
            const Decision answer = m_queries[pair].decide(pose, m_settings);
            const bool truth = m_truth.decide(pose, m_exact).collides;
            const bool wrong = answer.collides != truth;
            (answer.collides ? m_falseAlarms : m_misses) += wrong ? 1U : 0U;
            m_colliding += truth ? 1U : 0U;
            const auto ticket = m_audit.count(answer, {m_seed, pair, m_frame});
            if (ticket) {
                m_waiting.push_back({pose, *ticket});
            }
            const bool checked = recheck();
            // Only then do the bounds and the truth come closer to each other.
            if (wrong || ticket || checked) {
                m_held = m_held && m_audit.missesAtMost() >= m_misses && m_audit.falseAlarmsAtMost() >= m_falseAlarms;
            }
        }
        ++m_frame;
    }

    void addTo(Sums& sums) const {
        const Audit::Tally yes = m_audit.yes().estimated();
        const Audit::Tally no = m_audit.no().estimated();
        ++sums.runs;
        sums.held += m_held ? 1U : 0U;
        sums.alarms += m_audit.exceeded() ? 1U : 0U;
        sums.answers += m_frame * pairs;
        sums.estimated += yes.estimated + no.estimated;
        sums.colliding += m_colliding;
        sums.misses += m_misses;
        sums.falseAlarms += m_falseAlarms;
        sums.chosen += yes.chosen + no.chosen;
        sums.checked += yes.checked + no.checked;
        sums.answerWork += static_cast<double>(m_audit.answerWork());
        sums.checkWork += static_cast<double>(m_audit.checkWork());
        sums.missBounds += m_audit.missBound();
        sums.falseAlarmBounds += m_audit.falseAlarmBound();
    }

  private:
    struct Waiting {
        Pose pose;
        Audit::Ticket ticket;
    };

    /// As the comment at Audit has it.
    bool recheck() {
        const std::uint64_t allowance = m_audit.allowance();
        if (m_waiting.empty() || allowance == 0) {
            return false;
        }
        const std::uint64_t before = m_begun ? m_checked.work : 0;
        m_checked =
            m_begun ? m_check.resume({allowance}) : m_check.decide(m_waiting.front().pose, m_exact, {allowance});
        m_begun = !m_checked.certain;
        m_audit.charge(m_checked.work - before);
        if (m_begun) {
            return false;
        }
        m_audit.record(m_waiting.front().ticket, m_checked.collides);
        m_waiting.pop_front();
        return true;
    }

    DecideSettings m_settings;
    DecideSettings m_exact = withoutWitness();
    std::uint64_t m_seed;
    std::uint64_t m_frame = 0;
    std::vector<Path> m_paths;
    std::vector<Query> m_queries;
    Query m_truth, m_check;
    Audit m_audit;
    std::deque<Waiting> m_waiting;
    Decision m_checked;
    bool m_begun = false;
    bool m_held = true;
    std::uint64_t m_misses = 0, m_falseAlarms = 0, m_colliding = 0;

    static DecideSettings withoutWitness() {
        DecideSettings settings = DecideSettings::exact();
        settings.tryWitness = false;
        return settings;
    }
};

Sums run(Motion motion, const Tree& tree, const DecideSettings& settings, const std::vector<Pose>& touching,
         std::size_t runs, int frames, std::uint64_t seed) {
    Sums sums;
    for (std::size_t i = 0; i < runs; ++i) {
        Scene scene(motion, tree, settings, touching, seed + i);
        for (int frame = 0; frame < frames; ++frame) {
            scene.step();
        }
        scene.addTo(sums);
    }
    return sums;
}

report::Row rowOf(const std::string& scenario, const NamedMesh& mesh, const char* method, const Sums& sums) {
    const auto runs = static_cast<double>(sums.runs);
    report::Row row;
    row.scenario = scenario;
    row.mesh = mesh.name;
    row.triangles = mesh.mesh.triangles.size();
    row.method = method;
    row.n = sums.answers;
    row.falseNegatives = static_cast<double>(sums.misses);
    row.falsePositives = static_cast<double>(sums.falseAlarms);
    row.colliding = static_cast<double>(sums.colliding);
    row.work = {{"answerWork", sums.answerWork}, {"checkWork", sums.checkWork}};
    row.measured = {{"runs", runs},
                    {"runsHeld", static_cast<double>(sums.held)},
                    {"runsAlarmed", static_cast<double>(sums.alarms)},
                    {"estimated", static_cast<double>(sums.estimated)},
                    {"chosen", static_cast<double>(sums.chosen)},
                    {"checked", static_cast<double>(sums.checked)},
                    {"meanMissBound", sums.missBounds / runs},
                    {"meanFalseAlarmBound", sums.falseAlarmBounds / runs}};
    return row;
}

}  // namespace

const char* name(Motion motion) noexcept {
    return motion == Motion::resting ? "resting" : "grazing";
}

void auditRuns(Motion motion, const Options& options, const std::vector<NamedMesh>& meshes, report::Report& results) {
    const std::size_t used = std::min<std::size_t>(meshes.size(), shownMeshes);
    const std::size_t runs = (options.quick ? 64 : 1'000) / (2 * used);
    const int frames = options.quick ? 100 : 300;
    const int longFrames = options.quick ? 1'000 : 20'000;
    const std::string kind = name(motion);
    Sums all;
    double largestShare = 0;
    for (std::size_t i = 0; i < used; ++i) {
        const Tree tree = build(meshes[i].mesh.view());
        CertificationSettings promise;
        promise.seed = options.seed;
        const std::vector<Pose> touching =
            test::grazingPoses(tree, tree, options.quick ? 40 : 200, 0, options.seed + 2);
        const std::uint64_t seed = options.seed + 100'000 * (i + 1);
        const auto both = [&](const char* method, const DecideSettings& settings) {
            const Sums sums = run(motion, tree, settings, touching, runs, frames, seed);
            results.rows.push_back(rowOf(kind, meshes[i], method, sums));
            all.runs += sums.runs;
            all.held += sums.held;
            largestShare = std::max(largestShare, sums.checkWork / (sums.answerWork + sums.checkWork));
            // What the bounds come down to in the end.
            results.rows.push_back(rowOf(kind + ", long", meshes[i], method,
                                         run(motion, tree, settings, touching, 1, longFrames, seed + runs)));
        };
        both("certified", calibrate(tree, tree, promise).settings);
        both("default", DecideSettings());
    }
    results.claims.push_back({"share of the " + kind + " runs whose bounds held at all times, upper 99 % limit",
                              upperRate(all.held, all.runs, 0.99), true, 0.95});
    results.claims.push_back({"largest share of a row's work for re-checks, " + kind, largestShare, false, 0.03});
}

}  // namespace grapeshot::bench
