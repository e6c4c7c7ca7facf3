#include "controller/operator/peer.h"

#include <nlohmann/json.hpp>

namespace flexarm {

nlohmann::json PeerJson(const Peer& peer) {
  return {{"name", peer.name}, {"uid", peer.uid}, {"pid", peer.pid}};
}

std::string PeerText(const Peer& peer) {
  return peer.name + " (uid " + std::to_string(peer.uid) + ", pid " + std::to_string(peer.pid) +
         ")";
}

}  // namespace flexarm
