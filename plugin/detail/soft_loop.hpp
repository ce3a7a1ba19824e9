// The soft side of one dispatcher: which pairs there are, and which bodies collide with themselves.
#pragma once

#include <LinearMath/btScalar.h>

#include <memory>
#include <span>
#include <vector>

#include <grapeshot/plugin/soft_contacts.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

struct Context;
class SoftPair;
class SoftSoftPair;

class SoftLoop {
  public:
    SoftLoop();
    ~SoftLoop();
    SoftLoop(const SoftLoop&) = delete;
    SoftLoop& operator=(const SoftLoop&) = delete;

    void add(Context& context, btSoftBody& body, const SelfCollision& how);
    bool remove(const btSoftBody* body);
    /// All that collide with themselves, in the order they came. Once per dispatch of the world's pairs.
    /// @param timeStep s
    void run(Context& context, btScalar timeStep);
    void appendContacts(const btSoftBody& body, std::vector<SoftContact>& contacts) const;

    void enter(const SoftPair& pair) { m_pairs.push_back(&pair); }
    void leave(const SoftPair& pair) { std::erase(m_pairs, &pair); }
    [[nodiscard]] std::span<const SoftPair* const> pairs() const { return m_pairs; }

  private:
    struct Itself {
        btSoftBody* body = nullptr;
        SelfCollision how;
        std::unique_ptr<SoftSoftPair> pair;
    };
    std::vector<Itself> m_selves;
    std::vector<const SoftPair*> m_pairs;
};

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
