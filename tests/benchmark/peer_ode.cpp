#include <ode/ode.h>

#include "peer.hpp"

namespace grapeshot::bench {

namespace {

class OdeBody {
  public:
    explicit OdeBody(MeshView mesh) : m_data(dGeomTriMeshDataCreate()) {
        dGeomTriMeshDataBuildSingle(m_data, mesh.vertices.data(), sizeof(Eigen::Vector3f),
                                    static_cast<int>(mesh.vertices.size()), mesh.triangles.data(),
                                    static_cast<int>(3 * mesh.triangles.size()), sizeof(Triangle));
        m_geometry = dCreateTriMesh(nullptr, m_data, nullptr, nullptr, nullptr);
    }
    OdeBody(const OdeBody&) = delete;
    OdeBody& operator=(const OdeBody&) = delete;
    ~OdeBody() {
        dGeomDestroy(m_geometry);
        dGeomTriMeshDataDestroy(m_data);
    }
    [[nodiscard]] dGeomID geometry() const { return m_geometry; }

  private:
    dTriMeshDataID m_data;
    dGeomID m_geometry = nullptr;
};

class Ode {
  public:
    Ode(MeshView a, MeshView b) : m_a(a), m_b(b) {}

    bool decide(const Pose& bInA) {
        dMatrix3 rotation{};  // three rows of four
        for (int row = 0; row < 3; ++row) {
            for (int column = 0; column < 3; ++column) {
                rotation[4 * row + column] = static_cast<dReal>(bInA.rotation(row, column));
            }
        }
        dGeomSetRotation(m_b.geometry(), rotation);
        dGeomSetPosition(m_b.geometry(), static_cast<dReal>(bInA.translation.x()),
                         static_cast<dReal>(bInA.translation.y()), static_cast<dReal>(bInA.translation.z()));
        dContactGeom contact;
        return dCollide(m_a.geometry(), m_b.geometry(), 1, &contact, sizeof(contact)) > 0;
    }

  private:
    OdeBody m_a, m_b;
};

}  // namespace

Peer odePeer(MeshView a, MeshView b) {
    // The library keeps tables of its own for as long as the program runs.
    static const bool ready = [] { return dInitODE2(0) != 0; }();
    static_cast<void>(ready);
    return makePeer("ODE", [ode = std::make_unique<Ode>(a, b)](const Pose& pose) { return ode->decide(pose); });
}

}  // namespace grapeshot::bench
