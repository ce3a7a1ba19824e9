#include <grapeshot/scf/continuous.hpp>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include <grapeshot/scf/detail/impact_search.hpp>
#include <grapeshot/scf/detail/placing.hpp>

namespace grapeshot {
namespace {

constexpr int drawBits = 16;  // random numbers of a part: more than there are

bool isUsable(const ImpactSettings& s) {
    return std::isfinite(s.maxDistance) && s.maxDistance >= 0 && std::isfinite(s.tolerance) && s.tolerance > 0 &&
           std::isfinite(s.exclusion) && s.exclusion >= 0 && s.auditShare >= 0 && s.auditShare <= 1;
}

/// Units that are kept for the sample; none where they are too few for one.
std::uint64_t spareOf(std::uint64_t units, float share) {
    const double spare = units == unlimited ? 0 : static_cast<double>(units) * static_cast<double>(share);
    return detail::impacts::caution * spare < detail::impacts::priceOfASample ? 0 : static_cast<std::uint64_t>(spare);
}

}  // namespace

struct ImpactQuery::State {
    State(const BallTree& treeA, const BallTree& treeB) : a(treeA) {
        if (&treeA != &treeB) {
            b.emplace(treeB);
        }
    }
    ImpactResult find(const SurfaceMotion& motionA, const SurfaceMotion* motionB, const ImpactSettings& settings,
                      const Budget& budget);
    ImpactResult findWithin(SurfaceMotion body, const ImpactSettings& settings, const Budget& budget);

    detail::MovingTree a;
    std::optional<detail::MovingTree> b;  ///< not of a body with itself
    detail::ImpactScratch scratch;
};

ImpactResult ImpactQuery::State::find(const SurfaceMotion& motionA, const SurfaceMotion* motionB,
                                      const ImpactSettings& settings, const Budget& budget) {
    ImpactResult result;
    const auto refused = [](Fault fault) {
        ImpactResult none;
        none.fault = fault;
        return none;
    };
    if (!isUsable(settings)) {
        return refused(Fault::badSetting);
    }
    if (const auto fault = detail::faultIn(motionA, a.tree().surface)) {
        return refused(*fault);
    }
    const float stretchA = detail::stretchToUse(motionA, a.tree().surface);
    float stretchB = stretchA;
    float turn = motionA.frame.turn.norm();
    if (motionB != nullptr) {
        if (const auto fault = detail::faultIn(*motionB, b->tree().surface)) {
            return refused(*fault);
        }
        stretchB = detail::stretchToUse(*motionB, b->tree().surface);
        turn = std::max(turn, motionB->frame.turn.norm());
    }
    if (std::isnan(stretchA) || std::isnan(stretchB)) {
        return refused(Fault::notFinite);
    }
    detail::Meter meter(budget);
    const detail::ImpactSpace space{&a, b ? &*b : &a, settings.maxDistance, settings.tolerance,
                                    b ? -1 : settings.exclusion};
    const RandomKey key{settings.seed, settings.pair, settings.step};
    const int parts = std::max(1, static_cast<int>(std::ceil(turn / detail::largestTurn)));
    result.stop = StopReason::certain;
    result.certain = true;
    for (int part = 0; part < parts; ++part) {
        a.begin(motionA, stretchA, {part, parts});
        if (b) {
            b->begin(*motionB, stretchB, {part, parts});
        }
        detail::ImpactSearch search(space, meter, key, static_cast<std::uint32_t>(part) << drawBits, result.work,
                                    scratch);
        // Only the last part is sampled: before it a sample could not bound what the rest of the step holds.
        const bool isLast = part + 1 == parts;
        bool finished = search.run(isLast ? spareOf(meter.left(result.work), settings.auditShare) : 0);
        if (!finished && isLast) {
            search.audit(result.miss);
            finished = search.isExhausted();
        }
        result.work = search.work();
        if (!a.isFinite() || !space.b->isFinite()) {
            const std::uint64_t work = result.work;
            result = refused(Fault::notFinite);
            result.work = work;
            return result;
        }
        const auto overall = [&](float time) {
            return std::min(1.0F, (static_cast<float>(part) + time) / static_cast<float>(parts));
        };
        result.freeUntil = overall(search.freeUntil());
        if (search.impact()) {
            result.impact = search.impact();
            result.impact->time = overall(search.impact()->time);
        }
        if (!finished) {
            result.certain = false;
            result.stop = StopReason::budget;
        }
        if (!finished || result.impact) {
            break;
        }
    }
    return result;
}

/// The frame moves nothing against anything: the body is searched in its own.
ImpactResult ImpactQuery::State::findWithin(SurfaceMotion body, const ImpactSettings& settings, const Budget& budget) {
    if (const auto fault = detail::faultIn(body.frame)) {
        ImpactResult refused;
        refused.fault = fault;
        return refused;
    }
    const RigidMotion frame = std::exchange(body.frame, {});
    ImpactResult result = find(body, nullptr, settings, budget);
    if (result.impact) {
        Impact& impact = *result.impact;
        const Pose pose = poseAt(frame, static_cast<double>(impact.time));
        impact.onA = apply(pose, impact.onA);
        impact.onB = apply(pose, impact.onB);
        impact.normal = pose.rotation * impact.normal;
    }
    return result;
}

ImpactQuery::ImpactQuery(const BallTree& a, const BallTree& b) : m_state(std::make_unique<State>(a, b)) {}
ImpactQuery::ImpactQuery(const BallTree& body) : m_state(std::make_unique<State>(body, body)) {}
ImpactQuery::ImpactQuery(ImpactQuery&&) noexcept = default;
ImpactQuery& ImpactQuery::operator=(ImpactQuery&&) noexcept = default;
ImpactQuery::~ImpactQuery() = default;

ImpactResult ImpactQuery::find(const SurfaceMotion& a, const SurfaceMotion& b, const ImpactSettings& settings,
                               Budget budget) {
    assert(m_state->b && "made of one tree: it is for the body with itself");
    return m_state->find(a, &b, settings, budget);
}

ImpactResult ImpactQuery::find(const SurfaceMotion& body, const ImpactSettings& settings, Budget budget) {
    assert(!m_state->b && "made of two trees");
    return m_state->findWithin(body, settings, budget);
}

}  // namespace grapeshot
