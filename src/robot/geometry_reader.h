#pragma once

#include <string>
#include <utility>
#include <vector>

#include "fit/primitive_fit.h"
#include "fit/primitives_file.h"
#include "robot/link_use.h"
#include "robot/urdf_reader.h"
#include "tccm_monitor/robot_model.h"

namespace tccm {

/// What stands for one link.
struct LinkGeometry {
  std::vector<PlacedShape> shapes;    ///< in the link's frame
  std::vector<LinkElement> elements;  ///< first_shape counts from the link's first; link is not set
  std::vector<std::string> warnings;  ///< what was left out of it
};

/// Reads the primitives of links: from the file of primitives, from the URDF's primitives, or by a
/// fit to its meshes.
class GeometryReader {
 public:
  /// Keeps references. @throws ConfigError where the file of primitives cannot be taken.
  GeometryReader(const ReadUrdf& urdf, const RobotModel::Config& config,
                 const RobotResources& resources, const LinkSelector& selector);

  /// Whether the URDF, or the file, gives the link one; what is empty counts as one.
  [[nodiscard]] bool hasShape(const urdf::Link& link) const;
  /// One for each of the links, in the same order; without shapes where all are empty.
  /// @throws ConfigError naming link and element.
  [[nodiscard]] std::vector<LinkGeometry> read(const std::vector<urdf::LinkConstSharedPtr>& links);

  [[nodiscard]] std::string cacheDefect() const { return cache_.saveProblem(); }

 private:
  /// A geometry and where it is.
  using Placed = std::pair<urdf::GeometrySharedPtr, urdf::Pose>;

  [[nodiscard]] bool isVisual(const urdf::Link& link) const;
  [[nodiscard]] std::vector<Placed> geometriesOf(const urdf::Link& link) const;
  [[nodiscard]] LinkGeometry readLink(const urdf::Link& link);
  void readElement(const Placed& placed, bool as_capsule, LinkGeometry& geometry) const;
  void fitMesh(const urdf::Mesh& mesh, LinkElement element, LinkGeometry& geometry);
  [[nodiscard]] PrimitiveFit fitOf(const urdf::Mesh& mesh);
  void requireMeantSizes(const urdf::Link& link, const LinkGeometry& geometry) const;
  [[nodiscard]] std::vector<double> visualSizes(const urdf::Link& link) const;
  [[nodiscard]] std::string contentOf(const std::string& uri, const std::string& owner) const;

  const ReadUrdf& urdf_;
  const RobotModel::Config& config_;
  const RobotResources& resources_;
  const LinkSelector& selector_;
  LinkPrimitives file_;
  FitCache cache_;
  std::size_t meshes_done_ = 0;
  std::size_t meshes_ = 0;
};

}  // namespace tccm
