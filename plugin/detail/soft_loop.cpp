#include <grapeshot/plugin/detail/soft_loop.hpp>

#include <algorithm>

#include <grapeshot/plugin/detail/proxy_id.hpp>
#include <grapeshot/plugin/detail/soft_pair.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

SoftLoop::SoftLoop() = default;
SoftLoop::~SoftLoop() = default;

void SoftLoop::add(Context& context, btSoftBody& body, const SelfCollision& how) {
    const auto known = std::ranges::find(m_selves, &body, &Itself::body);
    if (known != m_selves.end()) {
        known->how = how;
        return;
    }
    m_selves.push_back({&body, how, std::make_unique<SoftSoftPair>(context)});
}

bool SoftLoop::remove(const btSoftBody* body) {
    return std::erase_if(m_selves, [body](const Itself& self) { return self.body == body; }) > 0;
}

void SoftLoop::run(Context& context, btScalar timeStep) {
    for (const Itself& self : m_selves) {
        btSoftBody& body = *self.body;
        if (body.getBroadphaseHandle() == nullptr) {
            self.pair->forget();
            continue;
        }
        if (!body.isActive()) {
            continue;
        }
        SoftSoftTask task;
        task.look = context.dispatches;
        task.key = keyOf(body, body);
        task.world = rigidWorldOf(body);
        task.timeStep = timeStep;
        task.distance =
            self.how.thickness > 0 ? self.how.thickness : static_cast<float>(2 * body.getCollisionShape()->getMargin());
        task.exclusion = self.how.exclusion;
        task.spacing = self.how.spacing;
        task.budget = softBudget(context);
        reportSoftPair(context, body, body, self.pair->process(body, body, task), task.budget);
    }
}

void SoftLoop::appendContacts(const btSoftBody& body, std::vector<SoftContact>& contacts) const {
    for (const Itself& self : m_selves) {
        if (self.body == &body) {
            self.pair->appendContacts(body, contacts);
        }
    }
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
