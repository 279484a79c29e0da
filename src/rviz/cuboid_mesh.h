#pragma once

#include <OgreHardwareIndexBuffer.h>
#include <OgreHardwareVertexBuffer.h>
#include <OgreMaterial.h>
#include <OgreSimpleRenderable.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "rviz/cuboid_geometry.h"

namespace tccm {

/// Faces of cuboids as one object of the scene. Its buffers grow and are written anew with each
/// map. Faces that show the camera their backs are not handed to GL: half of them, and software GL
/// takes as long to find that out as to draw some.
class CuboidMesh : public Ogre::SimpleRenderable {
 public:
  CuboidMesh();
  ~CuboidMesh() override;
  CuboidMesh(const CuboidMesh&) = delete;
  CuboidMesh& operator=(const CuboidMesh&) = delete;

  /// @param faces are kept for as long as they are shown.
  void show(const CuboidFaces& faces);
  /// Shows none. Visibility would not do: rviz switches it on for all that a display has.
  void clear() { faces_ = nullptr; }

  void _notifyCurrentCamera(Ogre::Camera* camera) override;
  void _updateRenderQueue(Ogre::RenderQueue* queue) override;

  [[nodiscard]] Ogre::Real getBoundingRadius() const override { return radius_; }
  [[nodiscard]] Ogre::Real getSquaredViewDepth(const Ogre::Camera* camera) const override;

 private:
  using Ranges = std::array<CuboidFaces::Range, kSides>;  ///< by side

  /// Has room for so many faces.
  void reserve(std::size_t faces);
  void writeIndices(const Ranges& ranges);
  void useMaterial(bool translucent);

  Ogre::MaterialPtr material_;
  const CuboidFaces* faces_ = nullptr;  ///< those that are shown: some, or none
  Ogre::HardwareVertexBufferSharedPtr vertices_;
  std::vector<std::uint32_t> indices_;  ///< of all faces, for as many as there is room
  std::size_t faces_max_ = 0;
  Ranges drawn_{};       ///< those whose indices are in the buffer
  bool changed_ = true;  ///< they are of other faces
  Ogre::Real radius_ = 0.0F;
};

}  // namespace tccm
