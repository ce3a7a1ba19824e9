#include "judged_run.hpp"

#include <algorithm>
#include <cmath>

#include <scenes/plot.hpp>

namespace grapeshot::soft {

namespace {

constexpr double frame = 2 * timeStep;  // 30 Hz
constexpr double farAway = 50;          // m; no scene is so large

std::vector<Surface> softSurfaces(const World& world) {
    std::vector<Surface> surfaces;
    for (std::size_t i = 0; i < world.softBodies(); ++i) {
        surfaces.push_back(world.softSurface(i));
    }
    return surfaces;
}

std::string label(const JudgedRun& run) {
    return std::string(name(run.scene.world->method()));
}

}  // namespace

std::size_t lostNodes(const World& world, double limit) {
    std::size_t lost = 0;
    for (const Surface& surface : softSurfaces(world)) {
        for (const Eigen::Vector3d& point : surface.points) {
            lost += point.norm() <= limit ? 0 : 1;  // NaN compares false
        }
    }
    return lost;
}

std::size_t tangle(const World& world) {
    const std::vector<Surface> surfaces = softSurfaces(world);
    std::size_t count = 0;
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
        count += crossings(surfaces[i], surfaces[i]);
        for (std::size_t k = 0; k < i; ++k) {
            count += crossingsOfBoth(surfaces[i], surfaces[k]);
        }
    }
    return count;
}

std::size_t tangleOfApart(const World& world, const std::vector<Surface>& rest, double distance) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < world.softBodies(); ++i) {
        const Surface now = world.softSurface(i);
        const std::vector<Eigen::Vector3d>& points = rest[i].points;
        for (const CrossedEdge& crossed : crossedEdges(now, now)) {
            const Eigen::Vector3d edge = 0.5 * (points[crossed.from] + points[crossed.to]);
            const Triangle& t = now.triangles[crossed.triangle];
            count += (edge - (points[t[0]] + points[t[1]] + points[t[2]]) / 3).norm() > distance ? 1 : 0;
        }
    }
    return count;
}

std::size_t pierced(const World& world) {
    std::size_t count = 0;
    for (const Surface& surface : softSurfaces(world)) {
        for (std::size_t i = 0; i < world.rigidBodies(); ++i) {
            count += crossingsOfBoth(surface, world.rigidSurface(i));
        }
    }
    return count;
}

void JudgedRun::judge() {
    lastTangle = tangle(*scene.world);
    lastPierced = pierced(*scene.world);
    if (rest.empty()) {
        rest = softSurfaces(*scene.world);
    }
    if (scene.apart > 0) {
        lastApart = lastTangle > 0 ? tangleOfApart(*scene.world, rest, scene.apart) : 0;
        worstApart = std::max(worstApart, lastApart);
    }
    worstTangle = std::max(worstTangle, lastTangle);
    worstPierced = std::max(worstPierced, lastPierced);
    lost = lostNodes(*scene.world, farAway);
}

void JudgedRun::advance(std::size_t stride) {
    if (scene.beforeStep) {
        scene.beforeStep(static_cast<int>(records.size()));
    }
    records.push_back(scene.world->step());
    if (scene.wrong) {
        wrong += scene.wrong();
    }
    if (records.size() % stride == 0) {
        judge();
    }
}

scenes::Canvas picture(const JudgedRun& run, const std::string& title) {
    const World& world = *run.scene.world;
    scenes::Picture picture(1280, 720, run.scene.camera);
    picture.ground();
    const auto mesh = [](const Surface& surface) {
        scenes::Mesh drawn;
        for (const Eigen::Vector3d& point : surface.points) {
            drawn.vertices.emplace_back(point.cast<float>());
        }
        drawn.triangles = surface.triangles;
        return drawn;
    };
    for (std::size_t i = 0; i < world.rigidBodies(); ++i) {
        picture.mesh(mesh(world.rigidSurface(i)), {}, world.rigidColour(i));
    }
    for (std::size_t i = 0; i < world.softBodies() && run.lost == 0; ++i) {
        picture.mesh(mesh(world.softSurface(i)), {}, world.softColour(i));
    }
    picture.canvas().text({24, 40}, title, 15, {0.12F, 0.12F, 0.14F});
    return std::move(picture.canvas());
}

scenes::Canvas forceCurve(const std::vector<const JudgedRun*>& runs) {
    scenes::Plot plot{.title = "Force on the instrument",
                      .xLabel = "simulated time [s]",
                      .yLabel = "force, mean over each step [N]",
                      .logY = false,
                      .lines = {}};
    for (std::size_t i = 0; i < runs.size(); ++i) {
        scenes::Line line{.label = label(*runs[i]), .x = {}, .y = {}, .colour = scenes::seriesColour(i)};
        for (std::size_t step = 0; step < runs[i]->records.size(); ++step) {
            line.x.push_back(timeStep * static_cast<double>(step + 1));
            line.y.push_back(runs[i]->records[step].force);
        }
        plot.lines.push_back(std::move(line));
    }
    return scenes::draw(plot);
}

Frames framesOf(const JudgedRun& run) {
    Frames frames;
    for (std::size_t i = 0; i + 1 < run.records.size(); i += 2) {
        frames.whole.push_back(1e6 * (run.records[i].seconds + run.records[i + 1].seconds));
        frames.detection.push_back(1e6 * (run.records[i].detectionSeconds + run.records[i + 1].detectionSeconds));
    }
    return frames;
}

scenes::Canvas frameTimes(const std::vector<const JudgedRun*>& runs) {
    scenes::Plot plot{.title = "Processor time per frame of 1/30 s",
                      .xLabel = "simulated time [s]",
                      .yLabel = "time per frame [ms]",
                      .logY = true,
                      .lines = {}};
    std::size_t series = 0;
    for (const JudgedRun* run : runs) {
        const Frames frames = framesOf(*run);
        for (const auto& [what, times] : {std::pair{", whole", &frames.whole}, {", detection", &frames.detection}}) {
            scenes::Line line{.label = label(*run) + what, .x = {}, .y = {}, .colour = scenes::seriesColour(series++)};
            for (std::size_t i = 0; i < times->size(); ++i) {
                line.x.push_back(frame * static_cast<double>(i + 1));
                line.y.push_back(1e-3 * (*times)[i]);
            }
            plot.lines.push_back(std::move(line));
        }
    }
    return scenes::draw(plot);
}

namespace {

/// Detection beside a search to the end, in the same steps.
void appendComparison(report::Report& report, const JudgedRun& run) {
    std::vector<double> ours, exact;
    double contacts = 0, covered = 0;
    for (const StepRecord& record : run.records) {
        if (record.exact && record.exact->contacts > 0) {
            ours.push_back(1e6 * record.detectionSeconds);
            exact.push_back(1e6 * record.exact->seconds);
            contacts += static_cast<double>(record.exact->contacts);
            covered += static_cast<double>(record.exact->covered);
        }
    }
    if (ours.empty()) {
        return;
    }
    report::Row row;
    row.scenario = run.scene.name + ", detection in one step";
    row.triangles = run.scene.world->triangles();
    row.method = name(run.scene.world->method());
    row.peer = "exact traversal alone";
    row.n = ours.size();
    row.timeUs = report::quantiles(ours);
    row.ratio = report::quantiles(exact).mean / row.timeUs.mean;
    row.measured = {{"exact us", report::quantiles(exact).mean},
                    {"contacts within the thickness", contacts},
                    {"coverage", covered / contacts}};
    report.rows.push_back(row);
}

}  // namespace

void appendTo(report::Report& report, const JudgedRun& run, const JudgedRun* other) {
    const Frames frames = framesOf(run);
    const auto n = static_cast<double>(run.records.size());
    double contacts = 0, ofSelf = 0, work = 0, sampled = 0, force = 0, held = 0;
    std::vector<double> bounds;
    std::vector<double> forces;
    for (const StepRecord& record : run.records) {
        contacts += record.contacts / n;
        ofSelf += record.contactsOfSelf / n;
        work += record.work / n;
        sampled += record.sampled / n;
        held += record.held / n;
        force = std::max(force, record.force);
        forces.push_back(record.force);
        bounds.push_back(record.missBound);
    }
    const auto late = static_cast<double>(
        std::count_if(frames.whole.begin(), frames.whole.end(), [](double us) { return us > 1e6 * frame; }));
    report::Row row;
    row.scenario = run.scene.name + ", whole frame";
    row.triangles = run.scene.world->triangles();
    row.method = name(run.scene.world->method());
    row.n = frames.whole.size();
    row.timeUs = report::quantiles(frames.whole);
    row.work = {{"contacts/step", contacts}, {"of soft bodies/step", ofSelf}, {"units/step", work}};
    row.measured = {{"frames over 33 ms", late},
                    {"largest force N", force},
                    {"nodes held back/step", held},
                    {"tangled edges, worst", static_cast<double>(run.worstTangle)},
                    {"pierced edges, worst", static_cast<double>(run.worstPierced)},
                    {"tangled at the end", static_cast<double>(run.lastTangle)}};
    if (run.scene.apart > 0) {
        row.measured.emplace_back("of what was apart, worst", static_cast<double>(run.worstApart));
    }
    row.curves = {{"force N", forces}};
    report.rows.push_back(row);

    report::Row detection;
    detection.scenario = run.scene.name + ", detection";
    detection.triangles = row.triangles;
    detection.method = row.method;
    detection.n = row.n;
    detection.timeUs = report::quantiles(frames.detection);
    if (run.scene.world->method() == Method::grapeshot) {
        detection.measured = {{"sampled pairs/step", sampled}, {"miss bound, p99", report::quantile(bounds, 0.99)}};
    }
    if (other != nullptr) {
        detection.peer = name(other->scene.world->method());
        detection.ratio = report::quantiles(framesOf(*other).detection).mean / detection.timeUs.mean;
    }
    report.rows.push_back(detection);

    appendComparison(report, run);
    if (run.scene.world->method() != Method::grapeshot) {
        return;  // what others lose is told, not claimed
    }
    const auto claim = [&](const std::string& what, std::size_t value, std::size_t bound) {
        report.claims.push_back(
            {run.scene.name + ": " + what, static_cast<double>(value), false, static_cast<double>(bound)});
    };
    claim("nodes lost", run.lost, 0);
    if (run.scene.apart > 0) {
        claim("edges through what was apart at rest, at the end", run.lastApart, 0);
    }
    claim("tangled edges at the end", run.lastTangle, run.scene.toleratedTangle);
    claim("edges through rigid meshes at the end", run.lastPierced, run.scene.toleratedPierced);
    if (run.scene.wrong) {
        claim(run.scene.wrongName, run.wrong, 0);
    }
}

}  // namespace grapeshot::soft
