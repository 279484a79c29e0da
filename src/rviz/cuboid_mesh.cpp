#include "rviz/cuboid_mesh.h"

#include <OgreCamera.h>
#include <OgreHardwareBufferManager.h>
#include <OgreMaterialManager.h>
#include <OgreResourceGroupManager.h>
#include <OgreSceneNode.h>
#include <OgreTechnique.h>
#include <OgreVertexIndexData.h>
#include <rviz/ogre_helpers/version_check.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace tccm {
namespace {

using Ogre::HardwareBuffer;

constexpr float kFar = 1e4F;         ///< [m]
constexpr std::size_t kIndices = 6;  ///< of a face: two triangles
constexpr std::array<std::uint32_t, kIndices> kTriangles{0, 1, 2, 0, 2, 3};

Ogre::MaterialPtr newMaterial() {
  static int count = 0;
  const std::string name = "tccm_monitor/cuboids " + std::to_string(count++);
  Ogre::MaterialPtr material = Ogre::MaterialManager::getSingleton().create(
      name, Ogre::ResourceGroupManager::DEFAULT_RESOURCE_GROUP_NAME);
  material->setReceiveShadows(false);
  material->getTechnique(0)->setLightingEnabled(false);
  material->getTechnique(0)->setShadingMode(Ogre::SO_FLAT);  // a face has one colour
  return material;
}

}  // namespace

CuboidMesh::CuboidMesh() : material_(newMaterial()) {
  mRenderOp.operationType = Ogre::RenderOperation::OT_TRIANGLE_LIST;
  mRenderOp.useIndexes = true;
  mRenderOp.vertexData = new Ogre::VertexData;
  mRenderOp.indexData = new Ogre::IndexData;
  Ogre::VertexDeclaration& layout = *mRenderOp.vertexData->vertexDeclaration;
  layout.addElement(0, offsetof(CuboidVertex, x), Ogre::VET_FLOAT3, Ogre::VES_POSITION);
  // Bytes from red to opacity, as GL has them.
  layout.addElement(0, offsetof(CuboidVertex, color), Ogre::VET_COLOUR_ABGR, Ogre::VES_DIFFUSE);
  static_assert(sizeof(CuboidVertex) == 16, "the buffer's elements lie close together");
  useMaterial(false);
}

CuboidMesh::~CuboidMesh() {
  delete mRenderOp.vertexData;
  delete mRenderOp.indexData;
  Ogre::MaterialManager::getSingleton().remove(material_->getHandle());
}

void CuboidMesh::show(const CuboidFaces& faces) {
  const std::size_t count = faces.count();
  faces_ = count > 0 ? &faces : nullptr;
  changed_ = true;
  if (count == 0) return;
  reserve(count);
  mRenderOp.vertexData->vertexCount = count * CuboidFaces::kCorners;
  auto* out = static_cast<CuboidVertex*>(vertices_->lock(HardwareBuffer::HBL_DISCARD));
  for (const std::vector<CuboidVertex>& side : faces.sides) {
    out = std::copy(side.begin(), side.end(), out);
  }
  vertices_->unlock();
  const Eigen::Vector3f low = faces.bounds.min().cast<float>();
  const Eigen::Vector3f high = faces.bounds.max().cast<float>();
  setBoundingBox({low.x(), low.y(), low.z(), high.x(), high.y(), high.z()});
  radius_ = std::max(low.norm(), high.norm()) + (high - low).norm();
  useMaterial(faces.translucent);
  if (getParentSceneNode() != nullptr) getParentSceneNode()->needUpdate();
}

void CuboidMesh::reserve(std::size_t faces) {
  if (faces <= faces_max_) return;
  faces_max_ = faces + faces / 2;  // maps grow little by little
  Ogre::HardwareBufferManager& buffers = Ogre::HardwareBufferManager::getSingleton();
  vertices_ = buffers.createVertexBuffer(sizeof(CuboidVertex), faces_max_ * CuboidFaces::kCorners,
                                         HardwareBuffer::HBU_DYNAMIC_WRITE_ONLY_DISCARDABLE);
  mRenderOp.vertexData->vertexBufferBinding->setBinding(0, vertices_);
  indices_.resize(faces_max_ * kIndices);
  for (std::size_t i = 0; i < indices_.size(); ++i) {
    indices_[i] =
        static_cast<std::uint32_t>(i / kIndices * CuboidFaces::kCorners) + kTriangles[i % kIndices];
  }
  mRenderOp.indexData->indexBuffer =
      buffers.createIndexBuffer(Ogre::HardwareIndexBuffer::IT_32BIT, indices_.size(),
                                HardwareBuffer::HBU_DYNAMIC_WRITE_ONLY_DISCARDABLE);
}

void CuboidMesh::_notifyCurrentCamera(Ogre::Camera* camera) {
  SimpleRenderable::_notifyCurrentCamera(camera);
  if (faces_ == nullptr || getParentSceneNode() == nullptr) return;
  Ogre::Vector3 eye = camera->getDerivedPosition();
  if (camera->getProjectionType() == Ogre::PT_ORTHOGRAPHIC) {
    eye -= kFar * camera->getDerivedDirection();  // its rays are parallel
  }
  const Ogre::SceneNode& node = *getParentSceneNode();
  eye = node._getDerivedOrientation().Inverse() * (eye - node._getDerivedPosition());
  Ranges ranges;
  for (std::size_t side = 0; side < kSides; ++side) {
    ranges[side] = faces_->facing(static_cast<Side>(side), {eye.x, eye.y, eye.z});
  }
  writeIndices(ranges);
}

void CuboidMesh::_updateRenderQueue(Ogre::RenderQueue* queue) {
  if (faces_ != nullptr) SimpleRenderable::_updateRenderQueue(queue);
}

void CuboidMesh::writeIndices(const Ranges& ranges) {
  const auto same = [](const CuboidFaces::Range& a, const CuboidFaces::Range& b) {
    return a.begin == b.begin && a.end == b.end;
  };
  if (!changed_ && std::equal(ranges.begin(), ranges.end(), drawn_.begin(), same)) return;
  drawn_ = ranges;
  changed_ = false;
  Ogre::HardwareIndexBuffer& buffer = *mRenderOp.indexData->indexBuffer;
  auto* const begin = static_cast<std::uint32_t*>(buffer.lock(HardwareBuffer::HBL_DISCARD));
  std::uint32_t* out = begin;
  std::size_t before = 0;  // faces of the sides before
  for (std::size_t side = 0; side < kSides; ++side) {
    out = std::copy(indices_.data() + (before + ranges[side].begin) * kIndices,
                    indices_.data() + (before + ranges[side].end) * kIndices, out);
    before += faces_->count(static_cast<Side>(side));
  }
  buffer.unlock();
  mRenderOp.indexData->indexCount = static_cast<std::size_t>(out - begin);
}

void CuboidMesh::useMaterial(bool translucent) {
  material_->setSceneBlending(translucent ? Ogre::SBT_TRANSPARENT_ALPHA : Ogre::SBT_REPLACE);
  material_->setDepthWriteEnabled(true);  // else what lies behind would be drawn over it
#if OGRE_VERSION < OGRE_VERSION_CHECK(1, 10, 0)
  setMaterial(material_->getName());
#else
  setMaterial(material_);
#endif
}

Ogre::Real CuboidMesh::getSquaredViewDepth(const Ogre::Camera* camera) const {
  if (getParentSceneNode() == nullptr) return 0.0F;
  return (camera->getDerivedPosition() - getParentSceneNode()->_getDerivedPosition())
      .squaredLength();
}

}  // namespace tccm
