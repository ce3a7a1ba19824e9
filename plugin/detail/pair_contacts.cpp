#include <grapeshot/plugin/detail/pair_contacts.hpp>

#include <algorithm>
#include <cmath>

#include <grapeshot/plugin/detail/convert.hpp>
#include <grapeshot/plugin/detail/swept_contacts.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

/// Of a plate its thickness, of a ball two thirds of its radius; 0 for sheets.
float thicknessOf(const MeshModel& model) {
    return model.solid && model.report.area > 0 ? static_cast<float>(2 * model.report.volume / model.report.area)
                                                : 0.0F;
}

float halfDiagonal(const MeshModel& model) {
    return (model.tree.upper - model.tree.lower).norm() / 2;
}

void clear(ContactSet& set) {
    set.slots.clear();
    set.droppedRegions = 0;
}

}  // namespace

PairSize sizeOf(const PairShapes& shapes) {
    PairSize size;
    const MeshModel& a = *shapes.modelA->mesh;
    const SolidSize b = shapes.modelB ? SolidSize{halfDiagonal(*shapes.modelB->mesh), thicknessOf(*shapes.modelB->mesh)}
                                      : sizeOf(*shapes.b->getCollisionShape());
    const float thicknessA = thicknessOf(a);
    size.size = std::max(std::min(halfDiagonal(a), b.halfDiagonal), 1e-6F);
    // A sheet stops whatever has an inside; that one's thickness counts.
    size.thickness =
        thicknessA > 0 && b.thickness > 0 ? std::min(thicknessA, b.thickness) : std::max(thicknessA, b.thickness);
    return size;
}

/// How far contacts are searched for, m: what comes nearer until the next search, by the motion that makes one due or
/// within one step, is known before its margins touch. Patches of contact grow with it, and what a search costs.
static float searchDistance(const PairTask& task, float approach) {
    constexpr float spare = 0.05F;  // of the breaking threshold
    const float ahead = std::max(task.settings->reuse * task.breaking, approach) + spare * task.breaking;
    return ahead < task.breaking ? task.maxDistance - task.breaking + ahead : task.maxDistance;
}

PairSettings pairSettings(const PairTask& task, float approach) {
    const Settings& chosen = *task.settings;
    PairSettings settings;
    settings.method = chosen.method;
    settings.features = {chosen.searchWork, chosen.seed, task.pair};
    settings.maxDistance = searchDistance(task, approach);
    settings.slack = chosen.slack * task.size.size;
    settings.reuseMotion = chosen.reuse * task.breaking;
    settings.interior = chosen.interior;
    settings.local.lean = chosen.lean;
    settings.local.maxDistance = settings.maxDistance;
    settings.set.maxDistance = task.maxDistance;
    settings.set.mergeDistance = chosen.mergeDistance * task.size.size;
    settings.set.maxRegions = chosen.maxManifolds;
    settings.set.regions.spacing = chosen.contactSpacing * task.size.size;
    return settings;
}

PairResult PairContacts::step(const PairShapes& shapes, const PairTask& task) {
    const bool sweeps = sweptMotion(shapes, task) > 0 && !(task.again && m_swept);
    if (!task.again) {
        clear(m_ahead);
        m_swept = !sweeps;
    }
    Budget budget = task.budget;
    const bool touched = touches();
    if (sweeps && !touched && budget.work != unlimited) {
        budget.work /= 2;  // they have not met yet: what is ahead of them counts as much
    }
    const PairSettings settings = pairSettings(task, task.timeStep > 0 ? stepApproach(shapes, task) : anyApproach);
    const btTransform bInA = relative(shapes.a->getWorldTransform(), shapes.b->getWorldTransform());
    const Pose pose = toPose(bInA);
    PairResult result = shapes.modelB
                            ? update(*shapes.modelA->mesh, *shapes.modelB->mesh, pose, settings, budget, m_state)
                            : updateSolid(*shapes.modelA->mesh, PlacedSolid{shapes.b->getCollisionShape(), bInA}, pose,
                                          settings, budget, m_state);
    if (result.stop == StopReason::invalidInput) {
        clear(m_state.contacts);
        return result;
    }
    if (task.closestDistance > task.maxDistance) {
        findClosest(shapes, task, settings, pose, result);
    }
    if (sweeps && (result.stop != StopReason::budget || !touched)) {
        budget = task.budget;
        if (budget.work != unlimited) {
            budget.work -= std::min(budget.work, result.work);
        }
        clear(m_ahead);
        const Swept swept = sweptContacts(shapes, task, settings, budget, m_state.contacts, m_ahead);
        result.work += swept.work;
        m_swept = swept.complete;
        if (!m_swept) {
            result.certain = false;
            result.stop = StopReason::budget;
        }
    }
    return result;
}

bool PairContacts::touches() const {
    return hasPoints(m_state.contacts);
}

/// Only if there is no contact: looks twice as far until there is something.
void PairContacts::findClosest(const PairShapes& shapes, const PairTask& task, const PairSettings& settings,
                               const Pose& pose, PairResult& result) {
    if (touches()) {
        return;
    }
    std::vector<SurfaceContact> found;
    for (float reach = std::max(task.maxDistance, 0.01F * task.size.size); found.empty();) {
        reach = std::min(2 * reach, task.closestDistance);
        result.work += nearContacts(shapes, pose, reach, settings, task.budget, found);
        if (reach >= task.closestDistance) {
            break;
        }
    }
    const auto nearest = std::min_element(found.begin(), found.end(), [](const auto& left, const auto& right) {
        return left.signedDistance < right.signedDistance;
    });
    if (nearest != found.end()) {
        ContactSetSettings set = settings.set;
        set.maxDistance = task.closestDistance;
        merge(m_state.contacts, {&*nearest, 1}, pose, true, set);
    }
}

void PairContacts::forget() {
    clear(m_state.contacts);
    clear(m_ahead);
    forgetCandidates();
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
