"""The XML namespaces of SSP 1.0, of our annotations and of OMSimulator's, and the files of the schemas."""

from __future__ import annotations

SSD = "http://ssp-standard.org/SSP1/SystemStructureDescription"
SSC = "http://ssp-standard.org/SSP1/SystemStructureCommon"
SSV = "http://ssp-standard.org/SSP1/SystemStructureParameterValues"
SSM = "http://ssp-standard.org/SSP1/SystemStructureParameterMapping"
SSB = "http://ssp-standard.org/SSP1/SystemStructureSignalDictionary"
COSIM = "urn:cosim"
OMS = "https://raw.githubusercontent.com/OpenModelica/OMSimulator/master/schema/oms.xsd"
PREFIXES = {"ssd": SSD, "ssc": SSC, "ssv": SSV, "ssm": SSM, "ssb": SSB, "cosim": COSIM, "oms": OMS}
DESCRIPTION = f"{{{SSD}}}SystemStructureDescription"
PARAMETER_SET = f"{{{SSV}}}ParameterSet"
PARAMETER_MAPPING = f"{{{SSM}}}ParameterMapping"
SIGNAL_DICTIONARY = f"{{{SSB}}}SignalDictionary"
SCHEMAS = {
    DESCRIPTION: "SystemStructureDescription.xsd",
    PARAMETER_SET: "SystemStructureParameterValues.xsd",
    PARAMETER_MAPPING: "SystemStructureParameterMapping.xsd",
    SIGNAL_DICTIONARY: "SystemStructureSignalDictionary.xsd",
}
"""Root elements and the schemas that define them."""
