// SPDX-License-Identifier: GPL-3.0-or-later
//
// Robot descriptions (https://wiki.ros.org/urdf/XML): tinyxml2 says what the document means, and the text
// itself is changed only where a `<collision>` stands, so that comments, blanks and extensions survive.
// Scales go into the mesh before its tree is built, as balls do not stay balls under most of them; origins
// move the balls afterwards.
#include "io/urdf.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <nlohmann/json.hpp>

#ifdef SPHERETREE_HAS_TINYXML2
#include <tinyxml2.h>
#endif

#include "builders/build_tree.hpp"
#include "io/files.hpp"
#include "io/guarded.hpp"
#include "io/mesh_import.hpp"
#include "io/urdf_parts.hpp"
#include "medial/surface.hpp"

namespace spheretree::io {
namespace {

namespace fs = std::filesystem;
using builders::BuildSettings;
using Eigen::Vector3d;
using Json = nlohmann::json;

// --- budgets ---

/// A set of so many balls at most is a root with so many children, or the root alone.
void limitSpheres(BuildSettings& settings, std::uint32_t spheres) {
  settings.levels = spheres == 1 ? 1 : 2;
  settings.branch = std::max(spheres, builders::SettingLimits::kLeastBranch);
}

std::uint32_t countIn(const Json& json, std::uint32_t least, std::uint32_t most) {
  if (!json.is_number_unsigned() || json.get<std::uint64_t>() < least || json.get<std::uint64_t>() > most) {
    throw std::runtime_error(json.dump() + " is not a whole number in [" + std::to_string(least) + ", " +
                             std::to_string(most) + "]");
  }
  return json.get<std::uint32_t>();
}

void setBudget(BuildSettings& settings, const std::string& key, const Json& value) {
  using Limits = builders::SettingLimits;
  if (key == "spheres") {
    limitSpheres(settings, countIn(value, 1, Limits::kMostBranch));
  } else if (key == "levels") {
    settings.levels = countIn(value, 1, Limits::kMostLevels);
  } else if (key == "branch") {
    settings.branch = countIn(value, Limits::kLeastBranch, Limits::kMostBranch);
  } else if (key == "max_error") {
    if (!value.is_number() || value < 0 || value > 1)
      throw std::runtime_error("max_error " + value.dump() + " is not a fraction in [0, 1]");
    settings.maxError = value.get<double>();
  } else {
    throw std::runtime_error("'" + key + "' is not spheres, levels, branch or max_error");
  }
}

BuildSettings budgetOf(const std::string& whose, const Json& json, BuildSettings settings) {
  try {
    if (json.is_number()) {
      setBudget(settings, "spheres", json);
    } else if (json.is_object()) {
      for (const auto& [key, value] : json.items()) setBudget(settings, key, value);
    } else {
      throw std::runtime_error("is neither a number of spheres nor an object");
    }
  } catch (const std::runtime_error& reason) {
    throw std::runtime_error(whose + ": " + reason.what());
  }
  return settings;
}

#ifdef SPHERETREE_HAS_TINYXML2

using tinyxml2::XMLElement;

/// What is wrong with the document: becomes an Error with the names of file and link.
struct Refusal {
  Error error;
};

[[noreturn]] void refuse(const std::string& sentence) {
  throw Refusal{{ErrorCode::UnreadableInput, sentence}};
}

// --- reading the document ---

std::string textOf(const XMLElement& element, const char* attribute) {
  const char* text = element.Attribute(attribute);
  return text == nullptr ? "" : text;
}

std::vector<double> numbersOf(const XMLElement& element, const char* attribute, std::size_t count) {
  const std::string text = textOf(element, attribute);
  std::istringstream words(text);
  words.imbue(std::locale::classic());
  std::vector<double> numbers;
  for (double number = 0; words >> number;) numbers.push_back(number);
  const bool finite = std::all_of(numbers.begin(), numbers.end(), [](double n) { return std::isfinite(n); });
  if (numbers.size() != count || !words.eof() || !finite) {
    refuse(std::string("the ") + attribute + " '" + text + "' of <" + element.Name() + "> is not " +
           (count == 1 ? "a number" : std::to_string(count) + " numbers"));
  }
  return numbers;
}

Vector3d tripleOf(const XMLElement& element, const char* attribute) {
  const std::vector<double> n = numbersOf(element, attribute, 3);
  return {n[0], n[1], n[2]};
}

double lengthOf(const XMLElement& element, const char* attribute, bool mayBeZero = false) {
  const double length = numbersOf(element, attribute, 1)[0];
  if (length < 0 || (length == 0 && !mayBeZero))
    refuse(std::string("the ") + attribute + " of <" + element.Name() + "> is not above 0");
  return length;
}

/// From the frame of a geometry to that of its link: roll, pitch, yaw around fixed axes, in that order.
Eigen::Isometry3d originOf(const XMLElement& collision) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  const XMLElement* origin = collision.FirstChildElement("origin");
  if (origin == nullptr) return pose;
  if (origin->Attribute("xyz") != nullptr) pose.translation() = tripleOf(*origin, "xyz");
  if (origin->Attribute("rpy") != nullptr) {
    const Vector3d rpy = tripleOf(*origin, "rpy");
    pose.linear() =
        (Eigen::AngleAxisd(rpy.z(), Vector3d::UnitZ()) * Eigen::AngleAxisd(rpy.y(), Vector3d::UnitY()) *
         Eigen::AngleAxisd(rpy.x(), Vector3d::UnitX()))
            .toRotationMatrix();
  }
  return pose;
}

/// A `<collision>` of a link.
struct Collision {
  std::size_t place = 0;  ///< among all elements of that name in the document
  std::string link;
  const XMLElement* element = nullptr;
};

void collect(const XMLElement& element, std::size_t& seen, std::vector<Collision>& found) {
  const std::string_view name = element.Name();
  if (name.substr(0, 6) == "xacro:") {
    refuse("line " + std::to_string(element.GetLineNum()) + ": <" + std::string(name) +
           "> is xacro, not URDF; run xacro first");
  }
  if (name == "collision") {
    const XMLElement* link = element.Parent()->ToElement();
    const XMLElement* above = link == nullptr ? nullptr : link->Parent()->ToElement();
    const bool ofLink = above != nullptr && std::string_view(link->Name()) == "link" &&
                        above == element.GetDocument()->RootElement();
    if (ofLink) found.push_back({seen, textOf(*link, "name"), &element});
    ++seen;
  }
  for (const XMLElement* child = element.FirstChildElement(); child != nullptr;
       child = child->NextSiblingElement()) {
    collect(*child, seen, found);
  }
}

void parse(tinyxml2::XMLDocument& document, const std::string& text) {
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
    refuse("line " + std::to_string(std::max(document.ErrorLineNum(), 1)) + ": not well-formed XML (" +
           document.ErrorName() + ")");
  }
  const XMLElement* root = document.RootElement();
  if (root == nullptr || std::string_view(root->Name()) != "robot")
    refuse("is no robot description: no <robot>");
}

// --- finding meshes ---

bool isFolder(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored);
}

std::optional<fs::path> packageFolder(const std::string& name, const fs::path& robot,
                                      const RobotSettings& settings) {
  if (const auto given = settings.packages.find(name); given != settings.packages.end()) return given->second;
  for (const fs::path& folder : settings.packagePath) {
    if (isFolder(folder / name)) return folder / name;
    if (folder.filename() == name && isFolder(folder)) return folder;
  }
  // A description usually lies in a package, next to others.
  std::error_code ignored;
  for (fs::path folder = fs::absolute(robot, ignored).parent_path(); !folder.empty();
       folder = folder.parent_path()) {
    if (folder.filename() == name) return folder;
    if (isFolder(folder / name)) return folder / name;
    if (folder == folder.root_path()) break;
  }
  return std::nullopt;
}

fs::path meshPath(const std::string& uri, const fs::path& robot, const RobotSettings& settings) {
  if (uri.empty()) refuse("a <mesh> has no filename");
  const std::size_t scheme = uri.find("://");
  if (scheme == std::string::npos) return robot.parent_path() / uri;
  const std::string kind = uri.substr(0, scheme);
  const std::string rest = uri.substr(scheme + 3);
  if (kind == "file") return rest;
  if (kind != "package" && kind != "model") refuse("mesh " + uri + ": '" + kind + "' is not file or package");
  const std::string name = rest.substr(0, rest.find('/'));
  const std::optional<fs::path> folder = packageFolder(name, robot, settings);
  if (!folder)
    refuse("mesh " + uri + ": package '" + name + "' is not found; --package " + name +
           "=FOLDER says where it is");
  return *folder / rest.substr(std::min(rest.size(), name.size() + 1));
}

// --- from geometry to balls ---

/// A solid that stands for a geometry, in the geometry's own frame.
struct Body {
  std::string name;
  medial::TriangleMesh mesh;  ///< empty: `exact` is the geometry
  medial::Ball exact;
  double standOff = 0;  ///< balls grow by this much, and hold the geometry itself
};

Body readMesh(const XMLElement& element, const fs::path& robot, const RobotSettings& settings) {
  const std::string uri = textOf(element, "filename");
  const fs::path path = meshPath(uri, robot, settings);
  Result<ImportedMesh> imported = importMesh(path);
  if (!imported) throw Refusal{{imported.error().code, "mesh " + imported.error().message}};
  medial::TriangleMesh mesh = std::move(imported->mesh);
  if (element.Attribute("scale") != nullptr) {
    const Vector3d scale = tripleOf(element, "scale");
    if ((scale.array() == 0).any()) refuse("mesh " + uri + ": a scale of 0 leaves no solid");
    for (Vector3d& vertex : mesh.vertices) vertex = vertex.cwiseProduct(scale);
    if (scale.prod() < 0) {
      for (medial::TriangleMesh::Triangle& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
    }
  }
  Result<RepairedMesh> repaired = repairMesh(mesh, settings.repair);
  if (!repaired)
    throw Refusal{{repaired.error().code, "mesh " + path.string() + ": " + repaired.error().message}};
  return {uri, std::move(repaired->mesh), {}, 0};
}

Body bodyOf(const XMLElement& collision, const fs::path& robot, const RobotSettings& settings) {
  const XMLElement* geometry = collision.FirstChildElement("geometry");
  const XMLElement* shape = geometry == nullptr ? nullptr : geometry->FirstChildElement();
  if (shape == nullptr) refuse("a <collision> has no geometry");
  const std::string name = shape->Name();
  if (name == "mesh") return readMesh(*shape, robot, settings);
  if (name == "sphere") return {name, {}, {Vector3d::Zero(), lengthOf(*shape, "radius")}, 0};
  if (name == "box") {
    const Vector3d size = tripleOf(*shape, "size");
    if ((size.array() <= 0).any()) refuse("the size of <box> is not above 0");
    return {name, boxMesh(size), {}, 0};
  }
  if (name == "cylinder" || name == "capsule") {
    const bool capsule = name == "capsule";
    const double radius = lengthOf(*shape, "radius");
    const double length = lengthOf(*shape, "length", capsule);
    RoundMesh round = capsule ? capsuleMesh(radius, length) : cylinderMesh(radius, length);
    return {name, std::move(round.mesh), {}, round.standOff};
  }
  refuse("the geometry <" + name + "> is not known");
}

/// The ball in the frame of the link. Moving it rounds; what it holds must stay inside.
medial::Ball moved(const medial::Ball& ball, const Eigen::Isometry3d& pose, double standOff) {
  constexpr double kRounding = 1e-14;  // tens of roundings of numbers as large as these
  medial::Ball result{pose * ball.center, ball.radius + standOff};
  if (!pose.isApprox(Eigen::Isometry3d::Identity(), 0) || standOff > 0)
    result.radius += kRounding * (ball.center.norm() + pose.translation().norm() + result.radius);
  return result;
}

RobotPart partOf(const Collision& collision, Body body, const BuildSettings& budget,
                 const medial::Context& context) {
  RobotPart part;
  part.link = collision.link;
  part.geometry = body.name;
  const Eigen::Isometry3d pose = originOf(*collision.element);
  if (body.mesh.triangles.empty()) {
    part.balls = {{pose * body.exact.center, body.exact.radius}};
    part.diagonal = 2 * std::sqrt(3.0) * body.exact.radius;
    return part;
  }
  part.triangles = body.mesh.triangles.size();
  const Result<medial::Surface> surface = medial::Surface::create(std::move(body.mesh));
  if (!surface) throw Refusal{{surface.error().code, body.name + ": " + surface.error().message}};
  const Result<builders::BuildResult> build = builders::buildTree(*surface, budget, context);
  if (!build) throw Refusal{{build.error().code, body.name + ": " + build.error().message}};
  const std::span<const Node> level = build->tree.level(build->tree.levelCount() - 1);
  for (const medial::Ball& ball : builders::ballsOf(level))
    part.balls.push_back(moved(ball, pose, body.standOff));
  part.overhang = build->report.levels.back().metrics.overhangWorst.upper + body.standOff;
  part.diagonal = surface->diagonal();
  return part;
}

// --- writing ---

/// The blanks before `at` on its line, if there is nothing else.
std::string indentAt(std::string_view text, std::size_t at) {
  const std::size_t line = text.rfind('\n', at == 0 ? 0 : at - 1) + 1;  // npos + 1 is the first line
  const std::string_view before = text.substr(line, at - line);
  const std::size_t blanks = std::min(before.find_first_not_of(" \t"), before.size());
  return std::string(before.substr(0, blanks));
}

/// Child elements of the collision that are not about its shape, as XML.
std::string otherChildren(const XMLElement& collision) {
  std::string text;
  for (const XMLElement* child = collision.FirstChildElement(); child != nullptr;
       child = child->NextSiblingElement()) {
    const std::string_view name = child->Name();
    if (name == "origin" || name == "geometry") continue;
    tinyxml2::XMLPrinter printer(nullptr, true);
    child->Accept(&printer);
    text += printer.CStr();
  }
  return text;
}

std::string replacement(std::string_view old, const Collision& collision, const RobotPart& part,
                        const std::string& indent) {
  std::string text;
  const auto add = [&](std::string_view piece) {
    if (!text.empty()) text += "\n" + indent;
    text += piece;
  };
  for (const TextRange& comment : commentRanges(old))
    add(old.substr(comment.begin, comment.end - comment.begin));
  const std::string name = textOf(*collision.element, "name");
  const std::string extra = otherChildren(*collision.element);
  for (std::size_t k = 0; k < part.balls.size(); ++k) {
    const bool many = part.balls.size() > 1 && !name.empty();
    add(collisionXml(part.balls[k], many ? name + "_" + std::to_string(k) : name, extra, indent));
  }
  return text;
}

std::string rewritten(const std::string& text, const std::vector<Collision>& collisions,
                      const std::vector<RobotPart>& parts) {
  const std::vector<TextRange> places = elementRanges(text, "collision");
  std::string result;
  std::size_t done = 0;
  for (std::size_t k = 0; k < collisions.size(); ++k) {
    if (parts[k].triangles == 0) continue;  // a sphere stays as it is
    const TextRange& range = places.at(collisions[k].place);
    result += text.substr(done, range.begin - done);
    result += replacement(std::string_view(text).substr(range.begin, range.end - range.begin), collisions[k],
                          parts[k], indentAt(text, range.begin));
    done = range.end;
  }
  return result + text.substr(done);
}

void checkBudgets(const RobotSettings& settings, const XMLElement& robot) {
  std::set<std::string> names;
  for (const XMLElement* link = robot.FirstChildElement("link"); link != nullptr;
       link = link->NextSiblingElement("link"))
    names.insert(textOf(*link, "name"));
  for (const auto& [name, budget] : settings.links) {
    if (names.count(name) == 0)
      throw Refusal{{ErrorCode::InvalidArgument, "has no link '" + name + "', for which there is a budget"}};
  }
}

SphereRobot convert(const fs::path& path, const std::string& text, const RobotSettings& settings,
                    const medial::Context& context) {
  tinyxml2::XMLDocument document;
  parse(document, text);
  const XMLElement& root = *document.RootElement();
  checkBudgets(settings, root);
  std::vector<Collision> collisions;
  std::size_t seen = 0;
  collect(root, seen, collisions);

  SphereRobot robot;
  robot.name = textOf(root, "name");
  for (const Collision& collision : collisions) {
    try {
      const auto own = settings.links.find(collision.link);
      robot.parts.push_back(partOf(collision, bodyOf(*collision.element, path, settings),
                                   own == settings.links.end() ? settings.build : own->second, context));
    } catch (const Refusal& refusal) {
      throw Refusal{{refusal.error.code, "link '" + collision.link + "': " + refusal.error.message}};
    }
  }
  robot.urdf = rewritten(text, collisions, robot.parts);
  if (robot.parts.empty()) robot.warnings.emplace_back("no link has collision geometry");
  return robot;
}

#endif

}  // namespace

std::string whyNoUrdf() {
#ifdef SPHERETREE_HAS_TINYXML2
  return {};
#else
  return "robot descriptions need the package libtinyxml2-dev, which was missing when this program was built";
#endif
}

std::vector<LinkBalls> SphereRobot::links() const {
  std::vector<LinkBalls> links;
  for (const RobotPart& part : parts) {
    const auto at = std::find_if(links.begin(), links.end(),
                                 [&](const LinkBalls& link) { return link.link == part.link; });
    LinkBalls& link = at == links.end() ? links.emplace_back() : *at;
    link.link = part.link;
    link.balls.insert(link.balls.end(), part.balls.begin(), part.balls.end());
  }
  return links;
}

Result<std::map<std::string, BuildSettings>> readBudgets(const fs::path& path, BuildSettings& build) {
  return guarded(ErrorCode::UnreadableInput, path.string(),
                 [&]() -> Result<std::map<std::string, BuildSettings>> {
                   const Result<std::string> text = readFile(path);
                   if (!text) return text.error();
                   const Json json = Json::parse(*text);
                   if (!json.is_object()) throw std::runtime_error("is not a JSON object");
                   std::map<std::string, BuildSettings> links;
                   if (json.contains("default")) build = budgetOf("default", json["default"], build);
                   for (const auto& [key, value] : json.items()) {
                     if (key != "default" && key != "links")
                       throw std::runtime_error("'" + key + "' is neither default nor links");
                   }
                   if (!json.contains("links")) return links;
                   for (const auto& [link, budget] : json["links"].items())
                     links.emplace(link, budgetOf("link '" + link + "'", budget, build));
                   return links;
                 });
}

Result<SphereRobot> sphereRobot(const fs::path& path, const RobotSettings& settings,
                                const medial::Context& context) {
#ifdef SPHERETREE_HAS_TINYXML2
  return guarded(ErrorCode::UnreadableInput, path.string(), [&]() -> Result<SphereRobot> {
    const Result<std::string> text = readFile(path);
    if (!text) return text.error();
    try {
      return convert(path, *text, settings, context);
    } catch (const Refusal& refusal) {
      return Error{refusal.error.code, path.string() + ": " + refusal.error.message};
    }
  });
#else
  static_cast<void>(settings);
  static_cast<void>(context);
  return Error{ErrorCode::InvalidArgument, path.string() + ": " + whyNoUrdf()};
#endif
}

}  // namespace spheretree::io
