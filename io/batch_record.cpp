// SPDX-License-Identifier: GPL-3.0-or-later
//
// The record is written before its tree and holds the hash of the tree's file. So whatever was killed when, a
// tree is believed only when a record vouches for these very bytes, and a file that no record names was not
// written by a batch.

#include "io/batch_record.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <nlohmann/json.hpp>

#include "io/files.hpp"
#include "io/report_parts.hpp"
#include "io/tree_files.hpp"

namespace spheretree::io {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kKind = "spheretree batch record";
constexpr int kSchema = 1;

struct StateName {
  AssetState state;
  const char* name;
};
constexpr std::array kStates{StateName{AssetState::Pending, "pending"}, StateName{AssetState::Done, "done"},
                             StateName{AssetState::Missed, "missed"},
                             StateName{AssetState::Failed, "failed"}};

struct TroubleName {
  Trouble trouble;
  const char* name;
};
constexpr std::array kTroubles{TroubleName{Trouble::None, "none"},
                               TroubleName{Trouble::UnreadableInput, "unreadable_input"},
                               TroubleName{Trouble::UnsuitableMesh, "unsuitable_mesh"},
                               TroubleName{Trouble::ErrorBoundMissed, "error_bound_missed"},
                               TroubleName{Trouble::UnwritableOutput, "unwritable_output"},
                               TroubleName{Trouble::Internal, "internal"},
                               TroubleName{Trouble::Crashed, "crashed"},
                               TroubleName{Trouble::OutOfMemory, "out_of_memory"},
                               TroubleName{Trouble::TimedOut, "timed_out"}};

/// What a record says about the batch; the build's report follows.
Json headOf(const BatchAsset& asset, const AssetRecord& record) {
  return {{"kind", kKind},
          {"schema", kSchema},
          {"fingerprint", record.fingerprint},
          {"input", asset.input.generic_string()},
          {"output", asset.output},
          {"state", stateName(record.state)},
          {"trouble", record.trouble == Trouble::None ? Json(nullptr) : Json(troubleName(record.trouble))},
          {"reason", record.reason.empty() ? Json(nullptr) : Json(record.reason)},
          {"patience_seconds", record.patience > 0 ? Json(record.patience) : Json(nullptr)},
          {"tolerance", asset.tolerance > 0 ? Json(asset.tolerance) : Json(nullptr)}};
}

/// Names of files may hold any bytes; those that are not UTF-8 are replaced.
std::string textOf(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

std::string fingerprintOf(const BatchAsset& asset, const std::string& meshHash) {
  const Json parts = {{"schema", kSchema},
                      {"tool", Json::parse(toolJson())},
                      {"mesh", meshHash},
                      {"settings", Json::parse(settingsJson(asset.settings))},
                      {"repair", repairName(asset.repair)},
                      {"tolerance", exactNumber(asset.tolerance)}};
  return contentHash(parts.dump());
}

AssetRecord recordOfTree(const BatchAsset& asset, const std::string& fingerprint, std::string_view report,
                         std::string_view tree, const std::string& missedReason) {
  AssetRecord record;
  record.fingerprint = fingerprint;
  record.state = missedReason.empty() ? AssetState::Done : AssetState::Missed;
  record.trouble = missedReason.empty() ? Trouble::None : Trouble::ErrorBoundMissed;
  record.reason = missedReason;
  record.treeFileHash = contentHash(tree);
  Json json{{"batch", headOf(asset, record)}};
  json.update(Json::parse(withoutClock(std::string(report))));
  json["tree"]["file_hash"] = record.treeFileHash;
  json["tree"]["bytes"] = tree.size();
  record.json = textOf(json);
  return record;
}

AssetRecord recordOfFailure(const BatchAsset& asset, const std::string& fingerprint, Trouble trouble,
                            const std::string& reason, double patience) {
  AssetRecord record;
  record.fingerprint = fingerprint;
  record.state = AssetState::Failed;
  record.trouble = trouble;
  record.reason = reason;
  record.patience = patience;
  const Json json = {{"batch", headOf(asset, record)},
                     {"tool", Json::parse(toolJson())},
                     {"settings", Json::parse(settingsJson(asset.settings))}};
  record.json = textOf(json);
  return record;
}

Result<AssetRecord> readRecord(const std::filesystem::path& path) {
  Result<std::string> text = readFile(path);
  if (!text) return text.error();
  try {
    const Json json = Json::parse(text.value());
    const Json& head = json.at("batch");
    if (head.at("kind") != kKind || head.at("schema") != kSchema) throw std::invalid_argument("another kind");
    AssetRecord record;
    record.fingerprint = head.at("fingerprint").get<std::string>();
    const auto state = head.at("state").get<std::string>();
    for (const StateName& row : kStates)
      if (state == row.name) record.state = row.state;
    const std::string trouble = head.at("trouble").is_null() ? "none" : head.at("trouble").get<std::string>();
    for (const TroubleName& row : kTroubles)
      if (trouble == row.name) record.trouble = row.trouble;
    if (!head.at("reason").is_null()) record.reason = head.at("reason").get<std::string>();
    if (!head.at("patience_seconds").is_null()) record.patience = head.at("patience_seconds").get<double>();
    if (json.contains("tree")) record.treeFileHash = json.at("tree").at("file_hash").get<std::string>();
    record.json = std::move(*text);
    return record;
  } catch (const std::exception&) {
    return Error{ErrorCode::InvalidArgument, path.string() + ": is no record of a batch"};
  }
}

std::string stateName(AssetState state) {
  for (const StateName& row : kStates)
    if (row.state == state) return row.name;
  return kStates.front().name;
}

std::string troubleName(Trouble trouble) {
  for (const TroubleName& row : kTroubles)
    if (row.trouble == trouble) return row.name;
  return kTroubles.front().name;
}

}  // namespace spheretree::io
