// A concave shape that only its own program knows.
#pragma once

#include <BulletCollision/CollisionShapes/btConcaveShape.h>
#include <LinearMath/btAabbUtil2.h>

#include <algorithm>

namespace grapeshot::test {

/// A square of two triangles, 2 m wide, in the xz plane.
class OwnConcaveShape : public btConcaveShape {
  public:
    OwnConcaveShape() { m_shapeType = CUSTOM_CONCAVE_SHAPE_TYPE; }
    void processAllTriangles(btTriangleCallback* callback, const btVector3&, const btVector3&) const override {
        btVector3 corners[2][3] = {{{-1, 0, -1}, {-1, 0, 1}, {1, 0, 1}}, {{-1, 0, -1}, {1, 0, 1}, {1, 0, -1}}};
        callback->processTriangle(corners[0], 0, 0);
        callback->processTriangle(corners[1], 0, 1);
    }
    void getAabb(const btTransform& pose, btVector3& lower, btVector3& upper) const override {
        btTransformAabb({1, 0, 1}, getMargin(), pose, lower, upper);
    }
    void setLocalScaling(const btVector3&) override {}
    const btVector3& getLocalScaling() const override { return m_scaling; }
    void calculateLocalInertia(btScalar, btVector3& inertia) const override { inertia.setZero(); }
    const char* getName() const override { return "own"; }

  private:
    btVector3 m_scaling{1, 1, 1};
};

}  // namespace grapeshot::test
