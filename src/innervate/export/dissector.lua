-- Runs the layouts above: what innervate's own decoders do (src/innervate/wire), on Wireshark's tree.
-- Any bytes will do: what does not fit is flagged and shown as far as it goes.

local BAD_CRC, MALFORMED = "bad_crc", "malformed"
-- Wireshark brings `bit`, with every Lua from 5.1 (Wireshark 4.2 and older) to 5.4 (4.4 and newer);
-- from 5.3 on 7 / 1 is no whole number, and what has to be one is rounded down.
local bitop = rawget(_G, "bit") or rawget(_G, "bit32")
-- `wtap` is the older name.
local encaps = rawget(_G, "wtap_encaps") or rawget(_G, "wtap")
local protos = {}
local interface = { name = Field.new("frame.interface_name"),
  says = Field.new("frame.interface_description"), way = Field.new("frame.packet_flags_direction") }
local INBOUND, OUTBOUND = 1, 2
local SAID_MAX = 6 -- numbers of a frame in the list of packets

-- CRC-16/CCITT-FALSE of all bytes but the last two, by a table of every byte's remainder.
local remainders = {}
for byte = 0, 255 do
  local crc = bitop.lshift(byte, 8)
  for _ = 1, 8 do
    local high = bitop.band(crc, 0x8000) ~= 0
    crc = bitop.band(bitop.lshift(crc, 1), 0xFFFF)
    if high then crc = bitop.bxor(crc, 0x1021) end
  end
  remainders[byte] = crc
end

local function crc16(tvb)
  local crc, data = 0xFFFF, tvb:bytes(0, tvb:len() - 2)
  for i = 0, data:len() - 1 do
    local high = bitop.bxor(bitop.rshift(crc, 8), data:get_index(i))
    crc = bitop.bxor(bitop.band(bitop.lshift(crc, 8), 0xFFFF), remainders[high])
  end
  return crc
end

-- `bits` bits from bit `at` on, with the bytes that they are in.
local function number(tvb, at, bits, signed)
  local first = math.floor(at / 8)
  local range = tvb(first, math.floor((at + bits - 1) / 8) - first + 1)
  local value = math.floor(range:bitfield(at - 8 * first, bits)) -- 5.0 is given by some, too
  if signed and value >= 2 ^ (bits - 1) then value = value - math.floor(2 ^ bits) end
  return value, range
end

local function times(many, found)
  if many == 0 then return 1 end
  if type(many) == "string" then return found[many] or 0 end
  return many
end

-- Reads fields from bit `at` to at most `stop`; without a tree it only looks if they fit. Returns
-- the bit behind them and the numbers by name, or nil.
local function read(fields, tvb, at, stop, tree)
  local found = {}
  for _, field in ipairs(fields) do
    local count, done = times(field.many, found), 0
    while (count == REST and at < stop) or done < count do
      if field.group then
        local first = math.floor(at / 8)
        local node = tree and tree:add(field.proto, tvb(first, 0))
        at = read(field.group, tvb, at, stop, node)
        if not at then return nil end
        if node then node:set_len(math.floor((at + 7) / 8) - first) end
      else
        if at + field.bits > stop then return nil end
        if field.name ~= "" then
          local value, range = number(tvb, at, field.bits, field.signed)
          found[field.name] = value
          if tree then tree:add(field.proto, range, value) end
        end
        at = at + field.bits
      end
      done = done + 1
    end
  end
  return at, found
end

-- Bytes as a list of numbers of one field.
local function list(proto, tvb, first, last, tree)
  for i = first, last - 1 do tree:add(proto, tvb(i, 1), tvb(i, 1):uint()) end
end

local function complain(self, tree, what, text)
  tree:add_proto_expert_info(self.experts[what], text)
end

local function show_crc(self, tvb, tree)
  local size = tvb:len()
  local given, computed = tvb(size - 2, 2):uint(), crc16(tvb)
  local item = tree:add(self.crc, tvb(size - 2, 2), given)
  if given ~= computed then
    item:add_proto_expert_info(self.experts[BAD_CRC], string.format("Bad CRC, should be 0x%04X", computed))
  end
  return given == computed
end

-- A frame in the list of packets: its type and its first numbers.
local function line(name, fields, found)
  local said = {}
  for _, field in ipairs(fields) do
    local value = field.name ~= "" and field.many == 0 and found and found[field.name]
    if value and #said < SAID_MAX then said[#said + 1] = string.format("%s %d", field.name, value) end
  end
  return #said > 0 and name .. ": " .. table.concat(said, ", ") or name
end

-- Fields of a kind behind a head of `at` bits; says if they and nothing else are there.
local function body(self, tvb, tree, kind, at, stop)
  local known = self.kinds[kind]
  if not known then
    complain(self, tree, MALFORMED, "Malformed: no frame has this type")
    return "unknown type"
  end
  local part = tree:add(known.proto, tvb())
  local behind, found = read(known.fields, tvb, at, stop, part)
  if not behind then complain(self, tree, MALFORMED, "Malformed: too short for its type") end
  return line(known.name, known.fields, found), behind, found
end

-- Where a frame comes from and goes to, as its interface says: "cell 7 port 1; A to B" is A's end of
-- a cable. On the air who sends it is known where it left, who hears it where it came in; frames may
-- say more.
local function ends(self, found)
  local says, way, name = interface.says(), interface.way(), interface.name()
  way = way and way.value
  local here, there = (says and tostring(says) or ""):match("; (.+) to (.+)$")
  if here and way == INBOUND then here, there = there, here end
  if not here and way ~= INBOUND then here = name and tostring(name) end
  if not there and way == INBOUND then there = name and tostring(name) end
  local said = self.ends
  if not said or not found then return here, there end
  local function node(number, else_)
    if number == nil then return else_ end -- not every layout has both
    return number == said.all and "all" or string.format("node %d", number)
  end
  return node(found[said.from], here), node(found[said.to], there)
end

-- A head of one byte, whose first `bits` bits are the version; the others are the type.
local function head(self, tvb, tree, bits, expected)
  local version, kind = number(tvb, 0, bits), number(tvb, bits, 8 - bits)
  tree:add(self.version, tvb(0, 1), version)
  tree:add(self.kind, tvb(0, 1), kind)
  if version ~= expected then complain(self, tree, MALFORMED, "Malformed: version") end
  return kind
end

-- A type of `bits` bits, its fields, a CRC and nothing else.
local function usual(self, tvb, tree)
  local size = tvb:len()
  if size < 3 then
    complain(self, tree, MALFORMED, "Malformed: too short")
    return "damaged"
  end
  local kind, range = number(tvb, 0, self.bits)
  tree:add(self.kind, range, kind)
  local name, behind, found = body(self, tvb, tree, kind, self.bits, 8 * size - 16)
  if behind and math.ceil(behind / 8) ~= size - 2 then
    complain(self, tree, MALFORMED, "Malformed: too long for its type")
  end
  show_crc(self, tvb, tree)
  return name, ends(self, found)
end

-- A sealed frame: only who shook hands can say more.
local function sealed(self, tvb, tree)
  local kind = tvb(0, 1):uint()
  tree:add(self.sealed, tvb(0, 1))
  if kind < SEALED_FRAME or kind > SEALED_LAST then return "handshake", ends(self) end
  tree:add(self.index, tvb(1, 4))
  tree:add(self.counter, tvb(5, 4))
  return string.format("sealed for %08x", tvb(1, 4):uint()), ends(self)
end

-- A kind of network: what it is called, the link type of its frames, how they are read (nil: as is
-- usual), and their layouts.
local function define(name, encap, run, layouts)
  local proto = Proto("innervate_" .. name, "innervate " .. name)
  local self = { kinds = {}, experts = {}, bits = layouts.bits, ends = layouts.ends }
  local prefix, made = "innervate." .. name .. ".", {}
  local function field(make, abbr, ...)
    local one = make(prefix .. abbr, ...)
    made[#made + 1] = one
    return one
  end
  local function bind(fields, path)
    for _, each in ipairs(fields) do
      if each.group then
        each.proto = field(ProtoField.none, path .. each.name, each.name, each.says)
        bind(each.group, path .. each.name .. ".")
      elseif each.name ~= "" then
        local make = each.signed and ProtoField.int32 or ProtoField.uint32
        each.proto = field(make, path .. each.name, each.name, base.DEC, nil, nil, each.says)
      end
    end
    return fields
  end
  local names = {}
  for kind, layout in pairs(layouts.kinds) do
    names[kind] = layout.name
    self.kinds[kind] = { name = layout.name, fields = bind(layout.fields, layout.abbr .. "."),
      proto = field(ProtoField.none, layout.abbr, layout.name) }
  end
  for kind, other in pairs(layouts.others or {}) do names[kind] = other end
  if layouts.common then self.common = bind(layouts.common, "") end
  if layouts.ack then
    self.ack = bind(layouts.ack, "ack.")
    self.hop_ack = field(ProtoField.none, "ack", "ack")
  end
  self.kind = field(ProtoField.uint8, "kind", "type", base.DEC, names)
  self.version = field(ProtoField.uint8, "version", "version", base.DEC)
  self.crc = field(ProtoField.uint16, "crc", "CRC", base.HEX)
  self.path = field(ProtoField.uint8, "path", "path", base.DEC)
  self.source_route = field(ProtoField.uint8, "source_route", "source route", base.DEC)
  self.failed = field(ProtoField.uint8, "failed", "failed nodes", base.DEC)
  self.payload = field(ProtoField.bytes, "payload", "payload")
  self.body = field(ProtoField.string, "body", "payload")
  self.sealed = field(ProtoField.uint8, "sealed.kind", "kind", base.HEX)
  self.index = field(ProtoField.uint32, "sealed.index", "index", base.HEX)
  self.counter = field(ProtoField.uint32, "sealed.counter", "counter", base.DEC)
  self.experts[BAD_CRC] = ProtoExpert.new(prefix .. BAD_CRC, "Bad CRC", expert.group.CHECKSUM,
    expert.severity.ERROR)
  self.experts[MALFORMED] = ProtoExpert.new(prefix .. MALFORMED, "Malformed", expert.group.MALFORMED,
    expert.severity.ERROR)
  proto.fields = made
  proto.experts = { self.experts[BAD_CRC], self.experts[MALFORMED] }
  function proto.dissector(tvb, pinfo, root)
    local tree = root:add(proto, tvb())
    pinfo.cols.protocol = string.upper(name)
    local is_sealed = tvb:len() >= SEALED_MIN and tvb(0, 1):uint() >= SEALED_MARK
      and tvb(0, 1):uint() < SEALED_END
    local info, from, to = (is_sealed and sealed or run or usual)(self, tvb, tree)
    tree:append_text(", " .. info)
    pinfo.cols.info = info
    if from then pinfo.cols.src = from end
    if to then pinfo.cols.dst = to end
    return tvb:len()
  end
  DissectorTable.get("wtap_encap"):add(encap, proto)
  protos[name] = proto
end
