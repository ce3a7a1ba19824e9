// One run of a scene with one method, step by step, and what an independent judge says of it.
#pragma once

#include <vector>

#include "demo.hpp"

namespace grapeshot::soft {

/// Nodes that are no numbers, or farther than `limit` from the origin, m.
[[nodiscard]] std::size_t lostNodes(const World& world, double limit);
/// Edges through triangles: of the soft bodies, each with itself and with the others.
[[nodiscard]] std::size_t tangle(const World& world);
/// Of these, of one body with itself, those that were farther apart than `distance` (m) in `rest`.
[[nodiscard]] std::size_t tangleOfApart(const World& world, const std::vector<Surface>& rest, double distance);
/// The same of the soft bodies with the rigid meshes.
[[nodiscard]] std::size_t pierced(const World& world);

struct JudgedRun {
    explicit JudgedRun(Scene made) : scene(std::move(made)) {}
    /// One step; judges crossings in every `stride`-th.
    void advance(std::size_t stride);
    void judge();

    Scene scene;
    std::vector<StepRecord> records;
    std::size_t wrong = 0;
    std::size_t worstTangle = 0, lastTangle = 0;
    std::size_t worstApart = 0, lastApart = 0;
    std::vector<Surface> rest;  ///< as they were at the first judgement
    std::size_t worstPierced = 0, lastPierced = 0;
    std::size_t lost = 0;  ///< nodes, at the last judgement
};

[[nodiscard]] scenes::Canvas picture(const JudgedRun& run, const std::string& title);
/// Force on the driven body over time.
[[nodiscard]] scenes::Canvas forceCurve(const std::vector<const JudgedRun*>& runs);
/// Time of each frame, detection and whole.
[[nodiscard]] scenes::Canvas frameTimes(const std::vector<const JudgedRun*>& runs);

/// Frames of 1/30 s are two steps: what each took, us.
struct Frames {
    std::vector<double> whole, detection;
};
[[nodiscard]] Frames framesOf(const JudgedRun& run);
void appendTo(report::Report& report, const JudgedRun& run, const JudgedRun* other);

}  // namespace grapeshot::soft
