#pragma once

#include <tinyxml2.h>

#include <string>
#include <unordered_map>

#include "mesh/mesh.h"

namespace tccm {

/// An element's text, without that of its children.
[[nodiscard]] std::string textOf(const tinyxml2::XMLElement& element);

/// The elements right below one.
class ChildElements {
 public:
  class Iterator {
   public:
    explicit Iterator(const tinyxml2::XMLElement* element) : element_(element) {}
    const tinyxml2::XMLElement& operator*() const { return *element_; }
    Iterator& operator++() {
      element_ = element_->NextSiblingElement();
      return *this;
    }
    bool operator!=(const Iterator& other) const { return element_ != other.element_; }

   private:
    const tinyxml2::XMLElement* element_;
  };

  explicit ChildElements(const tinyxml2::XMLElement& parent) : first_(parent.FirstChildElement()) {}
  [[nodiscard]] Iterator begin() const { return Iterator(first_); }
  [[nodiscard]] Iterator end() const { return Iterator(nullptr); }

 private:
  const tinyxml2::XMLElement* first_;
};

/// The elements of a document by their id.
class ElementIds {
 public:
  explicit ElementIds(const tinyxml2::XMLElement& root) { add(root); }

  /// The element that an attribute such as url="#id" refers to.
  /// @param name what the element has to be; empty where anything may follow.
  /// @throws ConfigError where there is none in this document.
  [[nodiscard]] const tinyxml2::XMLElement& at(const tinyxml2::XMLElement& from,
                                               const char* attribute,
                                               const std::string& name) const;

 private:
  void add(const tinyxml2::XMLElement& element);

  std::unordered_map<std::string, const tinyxml2::XMLElement*> elements_;
};

/// The positions and faces of a <geometry>'s <mesh>; nothing for a spline.
/// @throws ConfigError
[[nodiscard]] Mesh readGeometry(const tinyxml2::XMLElement& geometry, const ElementIds& ids);

}  // namespace tccm
