#include "scene_pairs.hpp"

#include <array>
#include <cmath>
#include <string>

#include <Eigen/Geometry>

#include <grapeshot/narrowphase/pair_update.hpp>
#include <report/machine.hpp>
#include <scenes/shapes.hpp>

namespace grapeshot::bench {

namespace {

constexpr int pairSteps = 300;
constexpr float reach = 0.06F;  // m

struct BodyPair {
    MeshModel a = makeTrackedModel(scenes::bumpySphere(1.0F, 0.2F, 6, 16, 11).view());
    MeshModel b = makeTrackedModel(scenes::torus(0.8F, 0.3F, 80, 32).view());

    /// B rocks by 0.3 degrees a step and slides by 1 mm, `height` above where the two touch.
    [[nodiscard]] Pose at(int step, float height) const {
        const float phase = 0.05F * static_cast<float>(step);
        const Eigen::Vector3f axis = Eigen::Vector3f(1, 0.3F, 0.2F).normalized();
        return {Eigen::AngleAxisf(0.1F * std::sin(phase), axis).toRotationMatrix(),
                {0.02F * std::sin(phase), touching + height, 0.02F * std::cos(phase)}};
    }
    float touching = 0;
};

bool collides(const BodyPair& bodies, float height) {
    PairState state;
    return update(bodies.a, bodies.b, bodies.at(0, height), {}, {}, state).collides;
}

/// Height of first touch above A's middle, to a tenth of a millimetre.
float findTouch(const BodyPair& bodies) {
    float low = 0;
    float high = 3;
    while (high - low > 1e-4F) {
        const float middle = (low + high) / 2;
        (collides(bodies, middle) ? low : high) = middle;
    }
    return high;
}

struct PairWay {
    const char* name;
    Method method;
    std::uint64_t searchWork;
};

report::Row pairRow(const BodyPair& bodies, const std::string& place, const char* method) {
    report::Row row;
    row.scenario = "methods";
    row.mesh = place;
    row.triangles = bodies.a.tree.triangles.size();
    row.method = method;
    row.n = pairSteps;
    return row;
}

report::Row measured(const BodyPair& bodies, const std::string& place, float height, const PairWay& way) {
    PairSettings settings;
    settings.method = way.method;
    settings.features.searchWork = way.searchWork;
    settings.maxDistance = reach;
    settings.slack = 0;  // a search in every step
    PairState state;
    std::vector<double> us;
    double work = 0;
    double contacts = 0;
    double sampled = 0;
    for (int step = 0; step < pairSteps; ++step) {
        const Pose pose = bodies.at(step, height);
        const double before = report::threadCpuUs();
        const PairResult result = update(bodies.a, bodies.b, pose, settings, {}, state);
        us.push_back(report::threadCpuUs() - before);
        work += static_cast<double>(result.work);
        contacts += result.rawContacts;
        sampled += result.sampled ? 1 : 0;
    }
    report::Row row = pairRow(bodies, place, way.name);
    row.timeUs = report::quantiles(us);
    row.work = {{"units", work / pairSteps}, {"contacts", contacts / pairSteps}};
    row.measured = {{"sampled", sampled / pairSteps}};
    return row;
}

/// Features alone: no dives, no audit.
report::Row ofTracker(const BodyPair& bodies, const std::string& place, float height) {
    TrackSettings settings;
    settings.maxDistance = reach;
    settings.spacing = 0.02F;
    settings.followDistance = reach;
    settings.frontCells = 64;
    Tracker tracker(bodies.a.features->balls, bodies.b.features->balls);
    TrackResult result;
    for (int warm = 0; warm < 4; ++warm) {
        tracker.step(rigidState(), rigidState(bodies.at(0, height)), settings, {}, result);
    }
    settings.maxDives = 0;
    settings.auditShare = 0;
    std::vector<double> us;
    double tracked = 0;
    double touching = 0;
    for (int step = 0; step < pairSteps; ++step) {
        const double before = report::threadCpuUs();
        tracker.step(rigidState(), rigidState(bodies.at(step, height)), settings, {}, result);
        us.push_back(report::threadCpuUs() - before);
        tracked += result.tracked;
        touching += static_cast<double>(result.contacts.size());
    }
    report::Row row = pairRow(bodies, place, "tracker");
    row.timeUs = report::quantiles(us);
    row.measured = {{"features", tracked / pairSteps},
                    {"featuresTouching", touching / pairSteps},
                    {"usPerFeature", row.timeUs.mean * pairSteps / std::max(1.0, tracked)}};
    return row;
}

}  // namespace

void measurePairs(const Options&, report::Report& results) {
    BodyPair bodies;
    bodies.touching = findTouch(bodies);
    constexpr std::array pairWays{PairWay{"adb", Method::adb, unlimited}, PairWay{"scf", Method::scf, 4096},
                                  PairWay{"automatic", Method::automatic, unlimited},
                                  PairWay{"scf, sampled", Method::scf, 256}};
    struct Place {
        const char* name;
        float height;
    };
    for (const auto& [name, height] : {Place{"pair touching", -0.01F}, Place{"pair near", 0.09F}}) {
        for (const PairWay& way : pairWays) {
            results.rows.push_back(measured(bodies, name, height, way));
        }
        results.rows.push_back(ofTracker(bodies, name, height));
    }
}

}  // namespace grapeshot::bench
