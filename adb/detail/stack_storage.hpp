// The memory of a descent's stack.
#pragma once

#include <vector>

#include <grapeshot/adb/detail/descent.hpp>

namespace grapeshot::detail {

/// Owns what a Descent works on, because code compiled per instruction set calls nothing of the standard library, and
/// grows as the descent asks. After a copy or a move it must be lent anew.
class StackStorage {
  public:
    /// To the descent, which keeps pointers to it.
    void lendTo(Descent& descent) {
        descent.stackA = m_sidesA.data();
        descent.stackB = m_sidesB.data();
        descent.capacity = m_sidesA.size();
        descent.owner = this;
        descent.grow = [](Descent& borrower) {
            auto& storage = *static_cast<StackStorage*>(borrower.owner);
            storage.m_sidesA.resize(2 * storage.m_sidesA.size());
            storage.m_sidesB.resize(2 * storage.m_sidesB.size());
            storage.lendTo(borrower);
        };
    }

  private:
    std::vector<Side> m_sidesA = std::vector<Side>(512);
    std::vector<Side> m_sidesB = std::vector<Side>(512);
};

}  // namespace grapeshot::detail
