#include "lattice.hpp"

#include <cassert>
#include <cstdint>
#include <limits>

namespace grapeshot::scenes::detail {

std::vector<double> refined(const std::vector<double>& values, int cells) {
    assert(cells >= 1 && values.size() >= 2);
    std::vector<double> result;
    for (std::size_t i = 0; i + 1 < values.size(); ++i) {
        assert(values[i] < values[i + 1]);
        for (int k = 0; k < cells; ++k) {
            result.push_back(values[i] + (values[i + 1] - values[i]) * k / cells);
        }
    }
    result.push_back(values.back());
    return result;
}

namespace {

class BoundaryBuilder {
  public:
    explicit BoundaryBuilder(const Lattice& lattice)
        : m_lattice(lattice),
          m_axes{&lattice.x, &lattice.y, &lattice.z},
          m_vertexOf(lattice.x.size() * lattice.y.size() * lattice.z.size(), none) {}

    Mesh build() {
        const Eigen::Vector3i count = cellCount();
        for (int i = 0; i < count[0]; ++i) {
            for (int j = 0; j < count[1]; ++j) {
                for (int k = 0; k < count[2]; ++k) {
                    addCell({i, j, k});
                }
            }
        }
        return std::move(m_mesh);
    }

  private:
    static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

    [[nodiscard]] Eigen::Vector3i cellCount() const {
        Eigen::Vector3i count;
        for (int axis = 0; axis < 3; ++axis) {
            count[axis] = static_cast<int>(m_axes[axis]->size()) - 1;
        }
        return count;
    }

    [[nodiscard]] bool filled(const Eigen::Vector3i& cell) const {
        Eigen::Vector3d middle;
        for (int axis = 0; axis < 3; ++axis) {
            if (cell[axis] < 0 || cell[axis] >= cellCount()[axis]) {
                return false;
            }
            middle[axis] = 0.5 * ((*m_axes[axis])[cell[axis]] + (*m_axes[axis])[cell[axis] + 1]);
        }
        return m_lattice.filled(middle);
    }

    void addCell(const Eigen::Vector3i& cell) {
        if (!filled(cell)) {
            return;
        }
        for (int axis = 0; axis < 3; ++axis) {
            for (int side = 0; side < 2; ++side) {
                Eigen::Vector3i neighbour = cell;
                neighbour[axis] += side == 0 ? -1 : 1;
                if (!filled(neighbour)) {
                    addFace(cell, axis, side);
                }
            }
        }
    }

    void addFace(const Eigen::Vector3i& cell, int axis, int side) {
        Eigen::Vector3i origin = cell;
        origin[axis] += side;
        const Eigen::Vector3i u = Eigen::Vector3i::Unit((axis + 1) % 3);
        const Eigen::Vector3i v = Eigen::Vector3i::Unit((axis + 2) % 3);
        const std::uint32_t a = vertex(origin);
        std::uint32_t b = vertex(origin + u);
        const std::uint32_t c = vertex(origin + u + v);
        std::uint32_t d = vertex(origin + v);
        if (side == 0) {
            std::swap(b, d);
        }
        m_mesh.triangles.push_back({a, b, c});
        m_mesh.triangles.push_back({a, c, d});
    }

    std::uint32_t vertex(const Eigen::Vector3i& node) {
        const auto key = (static_cast<std::size_t>(node[0]) * m_axes[1]->size() + static_cast<std::size_t>(node[1])) *
                             m_axes[2]->size() +
                         static_cast<std::size_t>(node[2]);
        if (m_vertexOf[key] == none) {
            m_vertexOf[key] = static_cast<std::uint32_t>(m_mesh.vertices.size());
            const Eigen::Vector3d at((*m_axes[0])[node[0]], (*m_axes[1])[node[1]], (*m_axes[2])[node[2]]);
            m_mesh.vertices.push_back(m_lattice.position(at).cast<float>());
        }
        return m_vertexOf[key];
    }

    const Lattice& m_lattice;
    const std::vector<double>* m_axes[3];
    std::vector<std::uint32_t> m_vertexOf;
    Mesh m_mesh;
};

}  // namespace

Mesh boundary(const Lattice& lattice) {
    return BoundaryBuilder(lattice).build();
}

}  // namespace grapeshot::scenes::detail
