// A promise for one pair of trees: "at most this share of the collisions is missed, at most this share of the clear
// poses is called a collision, with this confidence, on poses like these"; and the fastest settings that keep it.
//
// This work is based on:
// Anastasios Angelopoulos, Stephen Bates, Emmanuel Candes, Michael Jordan, Lihua Lei. Learn then Test: Calibrating
// Predictive Algorithms to Achieve Risk Control. Annals of Applied Statistics, 2025 (fixed-sequence testing)
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include <grapeshot/adb/query.hpp>

namespace grapeshot {

/// What is to be promised, and on which poses it is to be tested.
struct CertificationSettings {
    double missLimit = 0.01;           ///< alpha: missed collisions / colliding poses, in (0, 1)
    double falseAlarmLimit = 0.05;     ///< beta: false alarms / clear poses, in (0, 1)
    double confidence = 0.95;          ///< that both hold, in [0.5, 1)
    std::size_t poses = 8000;          ///< drawn, 1 to 10^7; more certify faster settings. Unused if poses are given
    std::uint64_t seed = 1;            ///< of the drawn poses
    std::uint64_t estimateSteps = 16;  ///< of the certified settings, 1 or more
    /// Poses of B in A's frame to certify on instead: independent draws of what is to come. Neighbouring frames of one
    /// motion are not independent: take every so many-th, of many motions. Only read during the call.
    std::span<const Pose> givenPoses = {};
    std::string givenName = "given";  ///< what the given poses are, for the certificate
};

/// Why no certificate could be given.
enum class Refusal {
    none,
    fewColliding,  ///< so few colliding poses that not even a setting without an error would do
    fewClear,      ///< likewise
    tooManyErrors  ///< even the safest settings err too often on both sides
};

/// A value. It holds for the two trees as they were, and for the distribution that `poses` names, not for others: on
/// grazing poses, say, the rates are many times those on Zachmann's. A scene that runs is watched by Audit.
struct Certificate {
    bool certified = false;
    Refusal refusal = Refusal::none;
    std::string reason;  ///< of the refusal, in words, with the numbers
    /// The fastest that passed; exact() if refused. `calibration` is null, the default table. Safe with and without
    /// `tryWitness`, with any fewer `estimateSteps`, with a higher acceptAt and a lower rejectAt.
    DecideSettings settings = DecideSettings::exact();

    double missLimit = 0;  ///< what was to be promised
    double falseAlarmLimit = 0;
    double confidence = 0;
    std::string poses;  ///< the distribution it holds for: "zachmann" (see certificationPoses) or the given name
    std::uint64_t seed = 0;
    std::size_t colliding = 0;  ///< poses of each kind
    std::size_t clear = 0;

    std::size_t misses = 0;       ///< of `settings` on these poses
    std::size_t falseAlarms = 0;  ///< likewise
    /// Clopper-Pearson bounds of what was tested, each at 1 - (1 - confidence) / 2; at most the limits. What is
    /// promised are the limits: these bounds were looked at after the choice.
    double missBound = 1;
    double falseAlarmBound = 1;

    double workPerPose = 0;       ///< mean units of a query with `settings` on these poses
    double exactWorkPerPose = 0;  ///< and with exact(), on the same tree
    std::uint64_t work = 0;       ///< units that this certificate took
};

/// Certifies at load time. Draws the poses, takes the exact answers, and walks two fixed paths: rejectAt upwards, with
/// every yes proven, counts misses on the colliding poses; acceptAt downwards, with every no proven, counts false
/// alarms on the clear ones. Each path is tested at 1 - (1 - confidence) / 2, so both ends hold together. Both ends in
/// one setting err no more often: a query that stops at the one limit would have come to it without the other limit as
/// well. Where one path ends at its start, that answer is always proven. Deterministic in the settings; the same on
/// every instruction set. Cost: an exact decide and two to three estimates a pose: some 30 ms for 8,000 poses of bodies
/// of 10,000 triangles.
/// @throws Error badSetting (a setting out of its range), notRigid (a given pose that decide does not take)
[[nodiscard]] Certificate calibrate(const Tree& a, const Tree& b, const CertificationSettings& settings = {});

}  // namespace grapeshot
