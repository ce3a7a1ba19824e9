// Bullet's own examples without a window: runs each for a while and says what became of it, a line each.
#include <cmath>
#include <cstdio>

#include <BulletSoftBody/btSoftBody.h>
#include <CommonInterfaces/CommonExampleInterface.h>
#include <CommonInterfaces/CommonGUIHelperInterface.h>
#include <CommonInterfaces/CommonRigidBodyBase.h>

#include <BasicDemo/BasicExample.h>
#include <Constraints/ConstraintDemo.h>
#include <ExtendedTutorials/SimpleCloth.h>
#include <Raycast/RaytestDemo.h>
#include <SoftDemo/SoftDemo.h>

namespace {

struct Example {
    const char* name;
    CommonExampleInterface::CreateFunc* create;
    int options;
};

constexpr Example examples[] = {
    {"BasicExample", BasicExampleCreateFunc, 1},
    {"RaytestDemo", RaytestCreateFunc, 1},
    {"AllConstraintDemo", AllConstraintCreateFunc, 1},
    {"SimpleCloth", ET_SimpleClothCreateFunc, 1},
    {"SoftDemo", SoftDemoCreateFunc, 30},
};
constexpr int steps = 60;

/// Some of them draw as they step.
struct NoDrawer : btIDebugDraw {
    void drawLine(const btVector3&, const btVector3&, const btVector3&) override {}
    void drawContactPoint(const btVector3&, const btVector3&, btScalar, int, const btVector3&) override {}
    void reportErrorWarning(const char*) override {}
    void draw3dText(const btVector3&, const char*) override {}
    void setDebugMode(int) override {}
    int getDebugMode() const override { return DBG_NoDebug; }
};

/// Mean height of everything, m.
double meanHeight(const btDiscreteDynamicsWorld& world) {
    double sum = 0;
    int count = 0;
    for (int i = 0; i < world.getNumCollisionObjects(); ++i) {
        const btCollisionObject* object = world.getCollisionObjectArray()[i];
        const btSoftBody* soft = btSoftBody::upcast(object);
        for (int n = 0; soft != nullptr && n < soft->m_nodes.size(); ++n, ++count) {
            sum += static_cast<double>(soft->m_nodes[n].m_x.y());
        }
        if (soft == nullptr) {
            sum += static_cast<double>(object->getWorldTransform().getOrigin().y());
            ++count;
        }
    }
    return count > 0 ? sum / count : 0.0;
}

}  // namespace

int main() {
    bool finite = true;
    for (const Example& example : examples) {
        for (int option = 0; option < example.options; ++option) {
            DummyGUIHelper helper;
            CommonExampleOptions options(&helper, option);
            CommonExampleInterface* made = example.create(options);
            made->initPhysics();
            btDiscreteDynamicsWorld* world = static_cast<CommonRigidBodyBase*>(made)->m_dynamicsWorld;
            NoDrawer drawer;
            world->setDebugDrawer(&drawer);
            for (int i = 0; i < steps; ++i) {
                made->stepSimulation(1.0F / 60);
            }
            const double height = meanHeight(*world);
            finite = finite && std::isfinite(height);
            std::printf("%s %d: %d objects, mean height %.3f\n", example.name, option, world->getNumCollisionObjects(),
                        height);
            world->setDebugDrawer(nullptr);
            made->exitPhysics();
            delete made;
        }
    }
    return finite ? 0 : 1;
}
