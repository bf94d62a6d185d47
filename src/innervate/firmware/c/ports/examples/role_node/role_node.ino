// A node on an Arduino of 32 bits with UARTs Serial1 and Serial2. Fit it to your board.
#include <role_node.h>

static HardwareSerial *const uarts[] = {&Serial1, &Serial2};
static const int COUNT = 2;
static const int NUMBER = 1;             // every node has another
static const int32_t SEED = 334214459;   // ... and another seed, not near
static role_node_t node;

static int32_t port_now(void *) { return (int32_t)(micros() & 0x3FFFFFFF); }

static int32_t port_send(void *, int32_t port, const uint8_t *bytes, int32_t count) {
  if (port >= COUNT) return count;  // a free socket
  int room = uarts[port]->availableForWrite();
  int taken = room < count ? room : (int)count;
  return (int32_t)uarts[port]->write(bytes, (size_t)taken);
}

static const innervate_port_t port_layer = {port_now, port_send, 0, 0, 0, 0};

void setup() {
  for (int i = 0; i < COUNT; i++) uarts[i]->begin(1000000);
  role_node_start(&node, &role_defaults, &port_layer, NUMBER, SEED, 1);
}

void loop() {
  for (int i = 0; i < COUNT; i++) {
    while (uarts[i]->available()) {
      uint8_t byte = (uint8_t)uarts[i]->read();
      role_node_bytes(&node, i, &byte, 1);
    }
  }
  role_node_poll(&node);
}
