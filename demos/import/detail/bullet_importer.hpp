// Bullet's importer with what Debian's build leaves out.
#pragma once

#include <BulletWorldImporter/btBulletWorldImporter.h>

#include <import/bullet_scene.hpp>

struct btGImpactMeshShapeData;

namespace grapeshot::import::detail {

class BulletImporter final : public btBulletWorldImporter {
  public:
    explicit BulletImporter(btDynamicsWorld& world) : btBulletWorldImporter(&world) {}

    /// In the order of the file, as Bullet does. Hierarchies of triangle meshes are built anew: those in a file are
    /// believed by Bullet without a look.
    bool convertAllObjects(bParse::btBulletFile* file) override;
    [[nodiscard]] const BulletSceneSummary& summary() const { return m_summary; }

  private:
    btCollisionShape* convertGImpact(btGImpactMeshShapeData& data);
    void convertShapes(bParse::btBulletFile& file);
    void convertWorldInfo(bParse::btBulletFile& file);
    template <class Data>
    void convertBody(Data& data);
    template <class Data>
    void convertObject(Data& data);
    void convertConstraints(bParse::btBulletFile& file);

    BulletSceneSummary m_summary;
};

}  // namespace grapeshot::import::detail
