// A dispatcher that computes the contacts of another one's pairs, into manifolds of its own.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>

#include <memory>
#include <vector>

#include <grapeshot/plugin/detail/dispatch_tables.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

/// All 2 x 36 x 36 places.
using TableCopy = std::vector<btCollisionAlgorithmCreateFunc*>;

/// What stands in the dispatcher's tables; where our algorithms do, `withoutOurs` gives what stood there before.
[[nodiscard]] TableCopy tablesOf(const btCollisionDispatcher& dispatcher, bool withoutOurs);

/// One pair's algorithm in a twin.
struct TwinAlgorithm {
    TwinAlgorithm(btCollisionDispatcher& dispatcher, btCollisionAlgorithm* algorithm)
        : m_dispatcher(&dispatcher), m_algorithm(algorithm) {}
    ~TwinAlgorithm();
    TwinAlgorithm(const TwinAlgorithm&) = delete;
    TwinAlgorithm& operator=(const TwinAlgorithm&) = delete;
    [[nodiscard]] btCollisionAlgorithm* get() const { return m_algorithm; }

  private:
    btCollisionDispatcher* m_dispatcher;
    btCollisionAlgorithm* m_algorithm;
};

/// Its configuration owns the pool for algorithms, with slots as large as those of the original: whoever made
/// algorithms of his own has asked for them there.
class TwinDispatcher {
  public:
    explicit TwinDispatcher(int slotBytes);
    void setTables(const TableCopy& tables);
    /// Null: nobody makes one.
    [[nodiscard]] std::unique_ptr<TwinAlgorithm> make(const btCollisionObjectWrapper& first,
                                                      const btCollisionObjectWrapper& second);
    btCollisionDispatcher& dispatcher() { return m_dispatcher; }

  private:
    btDefaultCollisionConfiguration m_configuration;
    btCollisionDispatcher m_dispatcher;
};

/// Bytes of a slot in the original's pool.
[[nodiscard]] int slotBytes(btCollisionDispatcher& original);

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
